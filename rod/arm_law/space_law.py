"""The law of an arm without a plane of symmetry, such as one with three chambers, and the rod in space that follows it.

Per rest length of the arm, with the curvatures kappa = (kappa_y, kappa_z) about two fixed directions of its sections
and the pressures p of its cavities, the cells have the potential w(kappa, p) without axial force, the stretch
lambda(kappa, p), and small twist and shear:

    M = dw/dkappa - N dlambda/dkappa,   stretch = lambda + N / EA,   (twist, shear_y, shear_z) = C (T, Q_y, Q_z)

for the moments M, the axial force N, the torque T and the shear forces Q. EA and C are taken at the curvature without
moment. All of them are polynomials. The clamped end turns the rod and shifts it, as functions of the moments there and
of p; the end of the material curve lies beside that of the axis.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from geometry.arrays import Array
from rod.arm.sections import PolynomialSection
from rod.arm_law.polynomial import Polynomial
from rod.arm_law.record import mass_of, record_of
from rod.arm_law.space_rod import SpaceRod
from rod.checked import check_table, finite
from rod.errors import RodError
from rod.weight import Mass

#: of the file
FORMAT = 1
#: by how much pressures may leave those of the law, over the largest
ROUNDING = 1e-9

_NUMBERS = ("pitch", "length", "clamp_length", "reach", "error")
_POLYNOMIALS = ("potential", "stretch", "axial_rigidity", "compliance", "clamp", "tip")


@final
@dataclass(frozen=True, eq=False)  # arrays inside
class SpaceLaw:
    """The law of an arm over the pressures of its cavities.

    Variables of polynomials are curvatures in 1/mm, moments in N mm and, for p, components of the pressures in kPa.
    """

    cavities: tuple[str, ...]
    pressures: Array  #: (r, m) kPa, rows of pressures; the law is known between them and 0 kPa
    onto: Array  #: (m, q): pressures times this are the variables p of the polynomials
    pitch: float  #: mm
    length: float  #: mm
    clamp_length: float  #: mm, of the piece by which the clamped end was measured
    reach: float  #: 1/mm, largest change of the curvature from that without moment
    error: float  #: of the moment between the states of the cell, over the largest moment; one standard deviation
    potential: Polynomial  #: w of (kappa_y, kappa_z, p), N
    stretch: Polynomial  #: lambda of (kappa_y, kappa_z, p)
    axial_rigidity: Polynomial  #: EA of (kappa_y, kappa_z, p), N
    compliance: Polynomial  #: the six upper components of C, of p: 1/(N mm2), 1/(N mm) and 1/N
    clamp: Polynomial  #: turns (rad) and shift (mm) along x, y and z, of (M_y, M_z, p)
    tip: Polynomial  #: the end of the material curve beside that of the axis, in the frame there, mm, of p
    mass: Mass | None = None  #: None: not known

    def __post_init__(self) -> None:
        if self.pressures.ndim != 2 or self.pressures.shape[1] != len(self.cavities):
            raise RodError("A law in space must have rows with a pressure for each cavity.")

    def __repr__(self) -> str:
        return f"SpaceLaw({', '.join(self.cavities)}, up to {self.pressures.max():g} kPa, {self.length:g} mm)"

    def at(self, pressures: Sequence[float]) -> "SpaceRod":
        """The rod at the pressures of all cavities in kPa, in the order of `cavities`.

        Raises `RodError` for another number of pressures, and for those that are not between rows of the law and 0 kPa.
        """
        from scipy.optimize import nnls  # its import takes longer than a rod

        given = np.array([finite(value, "A pressure in kPa") for value in pressures])
        names = ", ".join(self.cavities)
        if len(given) != len(self.cavities):
            raise RodError(f"The law has a pressure for each of {names}; {len(given)} were given.")
        largest = float(np.abs(self.pressures).max())
        matrix = np.vstack([self.pressures.T / largest, np.ones(len(self.pressures))])
        # parts of the rows that make up the pressures; what is left of one in all belongs to 0 kPa
        rows, target = np.column_stack([matrix, [*np.zeros(len(given)), 1.0]]), np.append(given / largest, 1.0)
        if nnls(rows, target)[1] > ROUNDING * len(target):
            told = ", ".join(f"{value:g}" for value in given)
            raise RodError(f"The pressures {told} kPa of {names} are not between rows of the law's pressures_kPa.")
        return self._rod(given @ self.onto, tuple(given.tolist()))

    def _rod(self, variables: Array, pressures: tuple[float, ...]) -> SpaceRod:
        rows, columns = np.triu_indices(3)
        compliance = np.zeros((3, 3))
        compliance[rows, columns] = self.compliance(variables[None])[0]
        compliance = compliance + compliance.T - np.diag(np.diag(compliance))
        w, stretch, EA = (one.at_last(variables) for one in (self.potential, self.stretch, self.axial_rigidity))
        return SpaceRod(
            section=PolynomialSection.of(w, stretch, EA, compliance, self.reach),
            clamp=self.clamp.at_last(variables),
            to_end=self.tip(variables[None])[0],
            pitch=self.pitch,
            length=self.length,
            clamp_reach=self.clamp_length,
            mass=self.mass,
            pressures=pressures,
        )

    def record(self) -> dict[str, Any]:
        """As it stands in law_in_space.json."""
        return {
            "format_in_space": FORMAT,
            "cavities": list(self.cavities),
            "pressures_kPa": self.pressures.tolist(),
            "onto": self.onto.tolist(),
            **{name: getattr(self, name) for name in _NUMBERS},
            **{name: getattr(self, name).record() for name in _POLYNOMIALS},
            "mass": None if self.mass is None else record_of(self.mass),
        }

    @staticmethod
    def from_record(record: Mapping[str, Any]) -> "SpaceLaw":
        """What `record` gave. Raises `RodError` for a file that cannot be used."""
        check_table(record, {"pressures_kPa": ("r", "m"), "onto": ("m", "q"), **dict.fromkeys(_NUMBERS, ())})
        missing = next((name for name in ("cavities", *_POLYNOMIALS) if name not in record), None)
        if missing:
            raise RodError(f"The key {missing!r} is missing.")
        values: dict[str, Any] = {name: float(record[name]) for name in _NUMBERS}
        values |= {name: Polynomial.from_record(record[name], name) for name in _POLYNOMIALS}
        pressures, onto = (np.array(record[key], float) for key in ("pressures_kPa", "onto"))
        return SpaceLaw(
            tuple(map(str, record["cavities"])), pressures, onto, **values, mass=mass_of(record.get("mass"))
        )
