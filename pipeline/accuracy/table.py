"""The convergence study as cells of a table, for the terminal and for the docs."""

from pipeline.accuracy.ladder import CONTACT, POINTS, TOLERANCE
from pipeline.accuracy.orders import Order, SeriesOrders
from pipeline.accuracy.record import REFERENCE_ELEMENT, ConvergenceStudy, StudyRow
from pipeline.accuracy.reference import END, NUMBERS, SCALARS

#: stages of a measurement, in the order of its column
STAGES = ("mesh", "set_up", "assembly", "factorization", "contact", "fit")
COLUMNS = (
    *("series", "", "dofs", "CPU s", "mesh / set-up / assembly / factors / contact / fit s", "MB", "factors"),
    *(f"{name} %" for name in NUMBERS.values()),
)
_UNITS = {TOLERANCE: "", CONTACT: " mm", POINTS: " points"}


def cells(row: StudyRow) -> list[str]:
    """One configuration; errors are the largest over the pressures, in per cent. Dashes where it failed."""
    varied = "" if row.value is None else f"{row.value:g}{_UNITS.get(row.series, ' mm')}"
    cost = row.result.cost
    if cost is None or not row.errors:
        return [row.series, varied, *["-"] * (len(COLUMNS) - 2)]
    cpu_per_wall = cost.cpu_seconds / cost.wall_seconds  # below 1 where other work shared the processor
    return [
        row.series,
        varied,
        f"{cost.degrees_of_freedom}",
        f"{cost.cpu_seconds:.1f}",
        " / ".join(f"{cpu_per_wall * cost.seconds[name]:.1f}" for name in STAGES),
        f"{cost.peak_memory_MB:.0f}",
        f"{cost.factorizations}",
        *(_largest(row, name) for name in NUMBERS),
    ]


def _largest(row: StudyRow, name: str) -> str:
    present = [error for errors in row.errors if (error := errors.by_name[name]) is not None]
    return f"{100 * max(present, key=abs):+.1f}" if present else ""


def reference_sentences(study: ConvergenceStudy) -> list[str]:
    """The references at every pressure, with two standard deviations."""
    sentences = []
    for references in study.references:
        named = {name: (reference,) for name in SCALARS if (reference := references.numbers[name])}
        shown = {**named, **({END: references.end} if references.end else {})}
        parts = [
            f"{NUMBERS[name]} = "
            + ", ".join(f"{reference.value:.4g} ± {2 * reference.std:.2g}" for reference in values)
            for name, values in shown.items()
        ]
        sentences.append(
            f"{references.pressure_kPa:g} kPa: {'; '.join(parts)} (1/mm, N mm², mm, N; ± two standard deviations)"
        )
    return sentences


def left_out_sentences(study: ConvergenceStudy) -> list[str]:
    """A note on the pressures without a reference; none where every pressure has one."""
    if not study.left_out_kPa:
        return []
    pressures = ", ".join(f"{pressure:g} kPa" for pressure in study.left_out_kPa)
    return [
        f"Note: {pressures} left out, because too few meshes reached that to extrapolate from; the table says nothing "
        "about the errors there."
    ]


def order_sentences(study: ConvergenceStudy) -> list[str]:
    """The orders of convergence of the series with the most accurate elements, one sentence per series."""
    by_series: dict[str, list[SeriesOrders]] = {}
    for orders in study.orders:
        if orders.series.split(",")[0] == REFERENCE_ELEMENT:
            by_series.setdefault(orders.series, []).append(orders)
    return [
        f"orders of convergence, {series}: "
        + "; ".join(f"{at_pressure.pressure_kPa:g} kPa: {_orders(at_pressure)}" for at_pressure in pressures)
        for series, pressures in by_series.items()
    ]


def _orders(orders: SeriesOrders) -> str:
    return ", ".join(f"{NUMBERS[name]} {_order(order)}" for name, order in orders.orders.items())


def _order(order: Order) -> str:
    """With one standard deviation and the number of meshes."""
    return f"{order.value:.1f} ± {order.std:.1f} ({order.meshes} meshes)"
