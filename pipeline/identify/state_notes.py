"""Rules on the states that a run has reached, and on the parameters identified from them."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from math import hypot, inf, isinf

import numpy as np

from fem.elements import ELEMENTS, Volumetric
from geometry import Reason, Values
from geometry.arrays import Array, Index
from pipeline.config.config import Config, Material
from pipeline.identify.parameters import Parameters
from pipeline.simulate.design_notes import SEVERAL
from pipeline.simulate.outcome import Outcomes, Record
from pipeline.values.run import State

#: mm and N; smaller errors of contact are not told
NOTHING = 1e-5
#: share of a volume that may have any stretch or J: extremes at sharp edges do not converge with the mesh
LEFT_OUT = 0.01
#: Poisson's ratio from which on a material keeps its volume, and the largest change of volume that is not mentioned
KEEPS_ITS_VOLUME, VOLUME_CHANGE = 0.49, 0.1
#: error of a Poisson ratio that follows from kappa
ROUNDING = 1e-9
#: distance of the material curve from its plane that is not mentioned: over the length, as much as a rod is wrong, and
#: over the deflection in the plane, as much as an unsymmetric mesh of a symmetric body makes
OUT_OF_PLANE, OF_DEFLECTION = 1e-3, 0.01
#: the same over the deflection of an arm without load, where it is more than the noise of a mesh over the length
ASIDE, NOISE = 0.1, 1e-5
#: rotation of the end in II below which an arm hardly bends, degrees
HARDLY_BENT = 3.0
#: largest ratio of the ends of the 95 % interval of a rigidity that counts as determined
DETERMINED = 4.0
#: R² of a single line below which it is mentioned
POORLY_DESCRIBED = 0.5
#: smallest and largest stretch up to which a law describes the rubber of the tensile test in examples/
#: (docs/how_to/choose_law.md); Hencky between 0.7 and 1.3 also by L. Anand, J. Appl. Mech. 46 (1979) 78. The other
#: laws are as good as their fit
HOLDS = {"svk": (1 / 1.1, 1.1), "hencky": (0.7, 1.3), "neo_hooke": (0.0, 1.5), "mooney_rivlin": (0.0, 1.7)}


@dataclass(frozen=True)
class Solved:
    """A run as far as its experiments and its identification went."""

    config: Config
    outcomes: Outcomes
    parameters: tuple[Parameters, ...]
    volumes: Array  #: (e,) of the elements, mm3
    regions: Mapping[str, Index] = field(default_factory=dict)  #: rows of the elements of another material, by name
    loads: tuple[Record, ...] = ()  #: of the validation


def check_states(solved: Solved) -> tuple[Reason, ...]:
    """What limits the use of the states that were reached, the most serious first."""
    if not solved.outcomes.records:
        return ()
    return tuple(reason for rule in RULES for reason in rule(solved))


def _unstable(solved: Solved) -> Iterator[Reason]:
    """Equilibria that the smallest push ends: an arm of full symmetry stands in them and falls over all the same."""
    records = sorted((*solved.outcomes.records, *solved.loads), key=lambda record: record.pressure_kPa)
    found = ((why, record) for record in records for why in record.instability if why.code.startswith("unstable"))
    for why, record in islice(found, 1):
        axis = why.values.get("axis")
        plane = "out of its plane" if axis == "z" else "in its plane"
        way = f"{plane} (along {axis})" if axis else "at a limit point"
        yield Reason("unstable_states", {"directions": why.values["directions"], "way": way, **_state(record.state)})


def _beyond_law(solved: Solved) -> Iterator[Reason]:
    """Stretches beyond those for which the laws of the solid and of its regions describe rubber, or are stable."""
    records, volumes = solved.outcomes.records, solved.volumes
    outside = np.setdiff1d(np.arange(len(volumes)), np.concatenate([[], *solved.regions.values()])).astype(int)
    parts = [("the walls", solved.config.material, outside)]
    parts += [(f"the part {name}", law, solved.regions[name]) for name, law in solved.config.materials.items()]
    for part, material, rows in parts:
        holds = _range_of(material)
        share, worst = max((_share_outside(r, rows, volumes, holds), n) for n, r in enumerate(records))
        if share > LEFT_OUT:
            fields, of_part = records[worst].fields, volumes[rows]
            smallest = _beyond_share(fields["smallest_stretch"][rows], of_part)
            largest = -_beyond_share(-fields["stretch"][rows], of_part)
            found = {"percent": 100.0 * share, "smallest": smallest, "largest": largest, **_state(records[worst].state)}
            laws = [law for law, (low, high) in HOLDS.items() if low <= smallest and largest <= high]
            instead = " or ".join([*laws[:1], "one fitted with pneurod material"])
            yield Reason("beyond_law", {"part": part, "law": material.law, **found, **holds, "instead": instead})


def _range_of(material: Material) -> dict[str, float]:
    """The stretches up to which a law describes the solid: as its configuration says, or as is known of rubber and of
    the stability of the law."""
    low, high = material.holds_between or HOLDS.get(material.law, (0.0, inf))
    least, most = material.built().stretch_limits
    return {"holds_from": max(low, least), "holds_to": min(high, most)}


def _share_outside(record: Record, rows: Index, volumes: Array, holds: Mapping[str, float]) -> float:
    """The share of the volume of some elements whose stretches are outside of a range."""
    fields = record.fields
    outside = (fields["smallest_stretch"] < holds["holds_from"]) | (fields["stretch"] > holds["holds_to"])
    return float(volumes[rows] @ outside[rows] / volumes[rows].sum())


def _beyond_share(values: Array, volumes: Array) -> float:
    """The value (e,) that all elements but `LEFT_OUT` of their volume (e,) reach."""
    order = np.argsort(values)
    filled = np.cumsum(volumes[order])
    return float(values[order][np.searchsorted(filled, LEFT_OUT * filled[-1])])


def _out_of_plane(solved: Solved) -> Iterator[Reason]:
    """The rod is a planar curve, and the errors given for it do not contain this distance.

    An arm that is moved little may leave the plane by less than a rod is wrong, and yet more than it bends in it.
    """
    length = solved.config.design.length
    records = solved.outcomes.records
    least = max(OUT_OF_PLANE * length, OF_DEFLECTION * max(map(_deflection, records)))
    far = [record for record in records if record.state.curve_z_mm >= least]
    free = [record for record in records if record.experiment == "II"]
    aside = [r for r in free if r.state.curve_z_mm >= max(ASIDE * _deflection(r), NOISE * length)]
    if far or aside:
        worst = max(aside or far, key=lambda record: record.state.curve_z_mm)
        distances = {"distance_mm": worst.state.curve_z_mm, "deflection_mm": _deflection(worst)}
        yield Reason("out_of_plane", {**distances, **_state(worst.state)})


def _deflection(record: Record) -> float:
    """Distance in the plane between the end of the material curve and its place at rest, mm; walls may bulge by more
    between."""
    curve = record.centreline
    return hypot(curve.x[-1] - curve.x[0] - curve.length, curve.y[-1] - curve.y[0])


def _volume_lost(solved: Solved) -> Iterator[Reason]:
    """Elements with one point for the volumetric part change their volume where it should be kept, and those with a
    pressure of their own do where they are too large for how the body deforms."""
    kept, worst = min(
        ((_beyond_share(record.fields["J"], solved.volumes), record.state) for record in solved.outcomes.records),
        key=lambda found: found[0],
    )
    ratio, lost = solved.config.material.built().poisson_ratio, 1.0 - kept
    if ratio < KEEPS_ITS_VOLUME - ROUNDING or lost < VOLUME_CHANGE:
        return
    is_mixed = ELEMENTS[solved.config.mesh.formulation].volumetric is Volumetric.PRESSURE
    values: Values = {"percent": 100 * lost, "share": 100 * LEFT_OUT, **_state(worst)}
    yield Reason("volume_lost" if is_mixed else "volume_lost_unevenly", values, worst.min_J_at_mm)


def _hardly_bent(solved: Solved) -> Iterator[Reason]:
    """The mesh, rounding and what the pressure does to the cross-section of the end matter more than usual."""
    free = (record for record in solved.outcomes.records if record.experiment == "II")
    bent = {record.state.pressure_kPa: abs(record.state.end_rotation_deg) for record in free}
    highest = max(bent, default=0.0)
    if bent and max(bent.values()) < HARDLY_BENT and solved.config.effects.pressure.acts:
        yield Reason("hardly_bent", {"pressure_kPa": highest, "bend_deg": bent[highest]})


def _few_reached(solved: Solved) -> Iterator[Reason]:
    """Fewer pressures with five parameters than were given, and too few to test how these change."""
    count, given = len(solved.parameters), len(solved.config.pressures_kPa)
    if 0 < count < SEVERAL <= given:
        yield Reason("few_reached", {"count": count, "given": given})


def _rigidity_open(solved: Solved) -> Iterator[Reason]:
    """The data of an arm that hardly bends, or whose curvature no line describes, leave the rigidity open."""
    wide = [
        (spread, p.pressure_kPa, symbol)
        for p in solved.parameters
        for symbol, spread in (("α₁", p.numbers["alpha1"]), ("α₂", p.numbers["alpha2"]))
        if spread.high > DETERMINED * spread.low
    ]
    if wide:
        spread, pressure, symbol = max(wide, key=lambda row: row[0].high - row[0].low)
        values = {"low": spread.low, "high": spread.high, "pressure_kPa": pressure}
        yield Reason("rigidity_open", {"rigidity": symbol, **values})


def _one_rigidity_poor(solved: Solved) -> Iterator[Reason]:
    """A single line that explains little of the curvature along the arm: its rigidity is a mean of parts that differ,
    and may be far from that of the inner part, beyond its interval."""
    single = [(p.by_cells.single_line.r2, p.pressure_kPa) for p in solved.parameters if not p.two_lines]
    r2, pressure = min(single, default=(1.0, 0.0))
    if r2 < POORLY_DESCRIBED:
        yield Reason("one_rigidity_poor", {"r2": r2, "pressure_kPa": pressure})


def _one_line_or_two(solved: Solved) -> Iterator[Reason]:
    """The data hardly decide between one line and two, or decide otherwise on a coarser mesh: α₂ is less certain than
    its interval says."""
    every = solved.parameters
    unclear = [p for p in every if not p.choice_is_clear or p.two_lines_on_coarser not in (None, p.two_lines)]
    if unclear:
        lines = min(unclear, key=lambda p: abs(p.evidence)).by_cells
        rigidities = {"single_N_mm2": lines.single_line.alpha.value, "two_N_mm2": lines.alpha2.value}
        yield Reason("one_line_or_two", {"pressures_kPa": [p.pressure_kPa for p in unclear], **rigidities})


def _long_cells(solved: Solved) -> Iterator[Reason]:
    """A single line because cavities follow one another at larger distances than the curvature is averaged over."""
    design = solved.config.design
    if not design.averages_within_cavities:
        return
    single = [p.pressure_kPa for p in solved.parameters if p.one_rigidity and not p.two_lines]
    if single:
        distances = {"averaging_mm": design.pitch, "between_mm": design.cavity_pitch}
        yield Reason("long_cells", {**distances, "pressures_kPa": single})


def _approximate_contact(solved: Solved) -> Iterator[Reason]:
    """Contact whose distances were compared with exact ones: the largest difference, and where none is known."""
    records = solved.outcomes.records
    known = [r.state for r in records if max(r.state.contact_error_mm, r.state.contact_error_N) > NOTHING]
    if known:
        worst = max(known, key=lambda state: (state.contact_error_mm, state.contact_error_N))
        errors = {
            "end_mm": max(state.contact_error_mm for state in known),
            "end_N": max(state.contact_error_N for state in known),
        }
        yield Reason("approximate_contact", {**errors, **_state(worst)})
    if unknown := [f"{r.state.experiment} at {r.state.pressure_kPa:g} kPa" for r in records if r.inexact]:
        yield Reason("contact_not_compared", {"states": unknown})


def _path_dependent_contact(solved: Solved) -> Iterator[Reason]:
    """Contact in creases that may depend on the load increments: the largest difference that is known."""
    worst = max(solved.outcomes.records, key=lambda record: record.path_dependence)
    if isinf(worst.path_dependence):
        yield Reason("folded_contact_open", _state(worst.state))
    elif worst.path_dependence:
        yield Reason("path_dependent_contact", {"percent": 100 * worst.path_dependence, **_state(worst.state)})


def _state(state: State) -> Values:
    return {"experiment": state.experiment, "pressure_kPa": state.pressure_kPa}


#: the rules, those whose reasons are most serious first
RULES: tuple[Callable[[Solved], Iterator[Reason]], ...] = (
    _unstable,
    _beyond_law,
    _out_of_plane,
    _volume_lost,
    _hardly_bent,
    _rigidity_open,
    _one_rigidity_poor,
    _one_line_or_two,
    _long_cells,
    _few_reached,
    _approximate_contact,
    _path_dependent_contact,
)
