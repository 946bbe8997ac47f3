"""Orders of convergence: the power of the mesh size with which the error of a number falls along a series of meshes.

The mesh size is n^(-1/3) with n degrees of freedom, so that graded meshes have one too. An order is fitted together
with the limit (`pipeline.identification.richardson`), from three meshes on.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from pipeline.accuracy.result import HEADLINE, RodNumbers
from pipeline.identification.richardson import extrapolated
from pipeline.store.json_values import JsonObject

#: fewest meshes that say something about an order
MIN_MESHES = 3
#: the number whose meaning depends on whether the law has one slope or two
RIGIDITY = "alpha2_N_mm2"


@dataclass(frozen=True)
class MeshNumbers:
    """What one mesh of a series gives at one pressure."""

    degrees_of_freedom: int
    numbers: RodNumbers


@dataclass(frozen=True)
class Order:
    """Order of convergence of one number."""

    value: float
    std: float  #: standard deviation; 1.0 where the meshes tell nothing about the order
    meshes: int  #: from how many meshes


@dataclass(frozen=True)
class SeriesOrders:
    """The orders of the headline numbers along one series of meshes, at one pressure."""

    series: str
    pressure_kPa: float
    orders: dict[str, Order]  #: by the names of `HEADLINE`, without those that too few meshes have

    @staticmethod
    def of(series: str, pressure_kPa: float, meshes: Sequence[MeshNumbers]) -> "SeriesOrders":
        """From the meshes of the series that reached the pressure.

        The rigidity of a single line and the second one of two lines are different numbers; the order of the rigidity
        is that of the meshes with the law of the finest one.
        """
        by_size = {mesh.degrees_of_freedom: mesh.numbers for mesh in meshes}
        finest = by_size[max(by_size)] if by_size else None
        orders = {}
        for name in HEADLINE:
            values = {
                n ** (-1 / 3): numbers.headline.by_name()[name]
                for n, numbers in by_size.items()
                if finest and (name != RIGIDITY or numbers.has_two_lines == finest.has_two_lines)
            }
            if len(values) >= MIN_MESHES:
                fit = extrapolated(list(values), list(values.values()))
                orders[name] = Order(fit.order, fit.order_std, len(values))
        return SeriesOrders(series, pressure_kPa, orders)

    def record(self) -> JsonObject:
        """As in accuracy.json."""
        orders = {name: asdict(order) for name, order in self.orders.items()}
        return {"series": self.series, "pressure_kPa": self.pressure_kPa, **orders}
