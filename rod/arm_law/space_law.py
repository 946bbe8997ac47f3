"""The law of an arm without a plane of symmetry, such as one with three chambers, and the rod in space that follows it.

Per rest length of the arm, with the curvatures kappa = (kappa_y, kappa_z) about two fixed directions of its sections
and the pressures p of its cavities, the cells have the potential w(kappa, p) without axial force, the stretch
lambda(kappa, p), and small twist and shear:

    M = dw/dkappa - N dlambda/dkappa,   stretch = lambda + N / EA,   (twist, shear_y, shear_z) = C (T, Q_y, Q_z)

for the moments M, the axial force N, the torque T and the shear forces Q. EA and C are taken at the curvature without
moment. The air in the cavities per rest length is V = -dw/dp. All of them are polynomials.
The clamped end turns the rod and shifts it, as functions of the moments there and of p; the end of the material curve
lies beside that of the axis. Both ends have other air than cells.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

import numpy as np

from geometry.arrays import Array
from rod.arm_law.polynomial import Polynomial
from rod.arm_law.space_rod import PolynomialSection, SpaceRod
from rod.checked import Amount
from rod.errors import RodError
from rod.same_pressure import Pressures, pressures_of, ratios_of
from rod.weight import Mass

#: by how much pressures may leave those of the law, over the largest
ROUNDING = 1e-9


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceLaw:
    """The law of an arm over the pressures of its cavities.

    Variables of polynomials are curvatures in 1/mm, moments in N mm and, for p, components of the pressures in kPa.
    """

    kind: ClassVar[str] = "space"
    has_plane: ClassVar[bool] = False
    plane: ClassVar[None] = None
    fractions: ClassVar[Mapping[str, float]] = {}
    notes: ClassVar[tuple[str, ...]] = ()
    cavities: Annotated[tuple[str, ...], "cavities"]
    #: kPa, rows of pressures; the law is known between them and 0 kPa
    pressures: Annotated[Array, "pressures_kPa", "r", "m"]
    onto: Annotated[Array, "onto", "m", "q"]  #: pressures times this are the variables p of the polynomials
    pitch: Annotated[float, "pitch_mm"]  #: mm
    length: Annotated[float, "length_mm"]  #: mm
    clamp_length: Annotated[float, "clamp_length_mm"]  #: mm, of the piece by which the clamped end was measured
    reach: Annotated[float, "reach_per_mm"]  #: 1/mm, largest change of the curvature from that without moment
    #: of the moment between the states of the cell, over the largest moment; one standard deviation
    error: Annotated[float, "error"]
    potential: Annotated[Polynomial, "potential"]  #: w of (kappa_y, kappa_z, p), N
    stretch: Annotated[Polynomial, "stretch"]  #: lambda of (kappa_y, kappa_z, p)
    axial_rigidity: Annotated[Polynomial, "axial_rigidity"]  #: EA of (kappa_y, kappa_z, p), N
    compliance: Annotated[Polynomial, "compliance"]  #: the six upper components of C, of p: 1/(N mm2), 1/(N mm) and 1/N
    volume: Annotated[Polynomial, "volume"]  #: air per rest length in each cavity, mm2, of (kappa_y, kappa_z, p)
    #: turns (rad) and shift (mm) along x, y and z, and air beyond that of cells in each cavity (mm3), of (M_y, M_z, p)
    clamp: Annotated[Polynomial, "clamp"]
    #: the end of the material curve beside that of the axis, in the frame there (mm), and such air (mm3), of p
    tip: Annotated[Polynomial, "tip"]
    mass: Annotated[Mass | None, "mass"] = None  #: None: not known

    def __post_init__(self) -> None:
        count = len(self.cavities)
        if self.pressures.ndim != 2 or self.pressures.shape[1] != count:
            raise RodError("A law in space must have rows with a pressure for each cavity.")
        if [one.coefficients.shape[1] for one in (self.volume, self.clamp, self.tip)] != [count, 6 + count, 3 + count]:
            raise RodError("A law in space must have the air of each cavity in `volume`, `clamp` and `tip`.")

    def __repr__(self) -> str:
        return f"SpaceLaw({', '.join(self.cavities)}, up to {self.pressures.max():g} kPa, {self.length:g} mm)"

    @property
    def rows(self) -> tuple[Pressures, ...]:
        """Rows of pressures, kPa; the law is known between them and 0 kPa."""
        return tuple(tuple(row) for row in self.pressures.tolist())

    @property
    def ratios(self) -> tuple[Pressures, ...]:
        """Ratios of its rows."""
        return ratios_of(self.rows)

    def at(self, pressures: Amount | Sequence[Amount]) -> "SpaceRod":
        """The rod at the pressures of all cavities in kPa, in the order of `cavities`.

        Raises `RodError` for another number of pressures, and for those that are not between rows of the law and 0 kPa.
        """
        given = pressures_of(pressures, self.cavities)
        largest = float(np.abs(self.pressures).max())
        if self._beyond(given, largest) > ROUNDING * (len(given) + 1):
            told, names = ", ".join(f"{value:g}" for value in given), ", ".join(self.cavities)
            raise RodError(f"The pressures {told} kPa of {names} are not between rows of the law's pressures_kPa.")
        return self._rod(np.array(given) @ self.onto, given)

    def _beyond(self, given: Pressures, largest: float) -> float:
        """How far pressures are from those between the rows and 0 kPa, over the largest (kPa)."""
        from scipy.optimize import nnls  # its import takes longer than a rod

        matrix = np.vstack([self.pressures.T / largest, np.ones(len(self.pressures))])
        # parts of the rows that make up the pressures; what is left of one in all belongs to 0 kPa
        rows = np.column_stack([matrix, [*np.zeros(len(given)), 1.0]])
        return float(nnls(rows, np.append(np.array(given) / largest, 1.0))[1])

    def ray(self, fractions: Pressures) -> None:
        """None: it has no plane in any ratio."""

    def pressures_along(self, fractions: Pressures) -> tuple[float, ...]:
        """0 kPa and the largest pressure up to which the law is known in a ratio, to a thousandth; 0 kPa for no other.

        fractions: of the largest pressure.
        """
        largest = float(np.abs(self.pressures).max())

        def is_known(pressure: float) -> bool:
            return self._beyond(tuple(part * pressure for part in fractions), largest) <= ROUNDING * (
                len(fractions) + 1
            )

        ends = sorted({float(row.max()) for row in self.pressures}, reverse=True)
        low, high = next((end for end in ends if is_known(end)), 0.0), ends[0]
        while high - low > 1e-3 * largest:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if is_known(middle) else (low, middle)
        return (0.0, low) if is_known(1e-3 * largest) else (0.0,)

    def _rod(self, variables: Array, pressures: tuple[float, ...]) -> SpaceRod:
        rows, columns = np.triu_indices(3)
        compliance = np.zeros((3, 3))
        compliance[rows, columns] = self.compliance(variables[None])[0]
        compliance = compliance + compliance.T - np.diag(np.diag(compliance))
        w, stretch, EA = (one.at_last(variables) for one in (self.potential, self.stretch, self.axial_rigidity))
        return SpaceRod(
            section=PolynomialSection.of(w, stretch, EA, compliance, self.reach),
            air=self.volume.at_last(variables),
            clamp=self.clamp.at_last(variables),
            tip=self.tip(variables[None])[0],
            pitch=self.pitch,
            length=self.length,
            clamp_reach=self.clamp_length,
            mass=self.mass,
            pressures=pressures,
        )
