"""Derivatives of the arm's own law by its design, from the states that its curves are made of."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import fem
from fem.cell.axis import circle, end_ripples, length_of
from fem.cell.design_change import DesignChange, DesignRate, design_rates
from fem.cell.lateral import lateral_rates
from fem.cell.piece import BendingPiece
from fem.equations.linear import SingularMatrix
from fem.materials import LAWS, Constant
from geometry import Design, DesignError
from geometry.arrays import Array
from geometry.meshing.mirror import Repetition
from geometry.meshing.moving import Movement
from pipeline.config.config import Config
from pipeline.config.material import Material
from pipeline.law.piece.point import KeptCurve, PiecePoint, stable
from pipeline.simulate.scene import make_layers
from rod.arm_law.curves import ACROSS, CellCurve, ClampCurve
from rod.arm_law.rates import CellRate, ClampRate, LawRate, slopes_of
from rod.cubics import cubic, parabola_slopes

#: what a worker gives for one curve: lists of numbers by the name of the parameter and of the quantity
Rates = Mapping[str, Mapping[str, Any]]
#: change of a parameter for the velocity of the nodes, which is the same for any, mm
CHANGE = 1e-3
#: change of angle (rad) and lengths (mm) in difference quotients of positions
DIFFERENCE = 1e-6
#: change of a constant of a material in difference quotients, over it or, of a stress, over the shear modulus
STEP_OF_CONSTANT = 1e-4
#: relative changes of the size of a body from a file, by the name of the parameter
SCALES = ("geometry.scale_x", "geometry.scale_y", "geometry.scale_z")


def changes_of(
    piece: BendingPiece,
    config: Config,
    repetition: Repetition,
    movements: Mapping[str, Movement | DesignError],
    by: Sequence[str] = (),
) -> dict[str, DesignChange]:
    """The parameters of a piece by which its states have derivatives: those of `by`, or all where it is empty."""
    changes = {}
    for name, step in material_steps(config).items():
        if not by or name in by:
            changes[name] = DesignChange.of_material(piece, step.less, step.more, step.step)
    for name, (value, _) in config.effects.constants.items():
        if (not by or name in by) and (change := _layer_change(piece, config, name, value)):
            changes[name] = change
    if config.design.is_from_file:
        for axis, name in enumerate(SCALES):
            velocity = np.zeros_like(piece.space.points)
            velocity[:, axis] = piece.space.points[:, axis]
            changes[name] = DesignChange.of_dimension(piece, velocity, piece.body.length if axis == 0 else 0.0)
        return changes
    for name, movement in movements.items():
        if isinstance(movement, Movement) and (not by or f"geometry.{name}" in by):
            changed = movement.moved(repetition, CHANGE)
            count = round((piece.body.length - repetition.middle) / repetition.half_pitch)
            mesh = changed.half_cell() if piece.start == "mirror" else changed.end_piece(count)
            velocity = (piece.space.positions_on(mesh) - piece.space.points) / CHANGE
            length = float(velocity[piece.plane[0], 0])
            changes[f"geometry.{name}"] = DesignChange.of_dimension(piece, velocity, length)
    return changes


def _layer_change(piece: BendingPiece, config: Config, key: str, value: float) -> DesignChange | None:
    """By a constant of the layer or of the hoops; None where the piece has none of them."""
    half = STEP_OF_CONSTANT * value
    configs = (replace(config, effects=config.effects.with_constant(key, value + by)) for by in (-half, half))
    changed = ([one for one in make_layers(piece.body, c) if one.name == key.split(".")[1]] for c in configs)
    for less, more in zip(*changed, strict=True):
        return DesignChange.of_layer(piece, less, more, 2.0 * half)
    return None


def cell_rates(piece: BendingPiece, points: Sequence[Any], curve: CellCurve | None = None) -> Rates:
    """Derivatives of the states (`pipeline.law.piece.measure.CellPoint`) of a cell at fixed curvature, per unit of each
    parameter.

    curve: of these states, whose rigidities out of the plane, if it has them, have derivatives as well.
    """
    h, last = piece.body.length, piece.curve[-1]

    def row(point: Any, rate: DesignRate, length: float) -> dict[str, Any]:
        angle, axis, c = point.state.angle, point.axis, point.state.distance
        normal, along = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        x = (piece.space.points + point.state.state.displacement)[[piece.curve[0], last], :2]
        eta, turned = float(x[1] @ along), point.slopes.by_angle[last, :2]
        turn = angle / h * length  # of the plane, at fixed curvature
        by_turn = np.array([1.0, 0.0, turned @ normal + eta, turned @ along - c, 0.0])
        now = np.array([angle, h, c, eta, x[0, 1]])
        change = np.array([0.0, length, *rate.end, rate.start]) + turn * by_turn
        ahead, behind = (end_ripples(*(now + sign * DIFFERENCE * change)) for sign in (1.0, -1.0))
        longer = length_of(angle, float(rate.end[0]), rate.start + float(rate.end[1])) / h
        return {
            "moment": rate.moment + point.slopes.moment_by_angle * turn,
            "stretch": longer + axis.stretch_by_angle * turn - axis.stretch * length / h,
            "ripple": ((ahead - behind) / (2.0 * DIFFERENCE)).tolist(),
        }

    return _table(piece, points, row, min(points, key=lambda point: abs(point.moment)), curve)


def clamp_rates(piece: BendingPiece, points: Sequence[PiecePoint]) -> Rates:
    """Derivatives of a clamped end at fixed moment, per unit of each parameter: the angle of the plane, and the end
    of the material curve there."""

    def row(point: PiecePoint, rate: DesignRate, length: float) -> dict[str, Any]:
        turn = -rate.moment / point.slopes.moment_by_angle
        cosine, sine = np.cos(point.state.angle), np.sin(point.state.angle)
        end = rate.end @ np.array([[cosine, sine], [-sine, cosine]])
        end = end + turn * point.slopes.by_angle[piece.curve[-1], :2]
        return {"angle": turn, "end": end.tolist(), "length": length, "height": rate.start}

    return _table(piece, points, row)


def _table(
    piece: BendingPiece,
    points: Sequence[PiecePoint],
    row: Any,
    middle: PiecePoint | None = None,
    curve: CellCurve | None = None,
) -> dict[str, dict[str, Any]]:
    """Lists of numbers, one of each point, by parameter and quantity; of the middle point also the largest stretch.

    Rigidities out of the plane of the curve change everywhere by the same part as at the middle point.
    """
    table: dict[str, dict[str, Any]] = {}
    for point in points:
        with stable(piece, point.state):
            rates = design_rates(piece, point.state, point.slopes, piece.changes, stretch=point is middle)
        for name, rate in rates.items():
            of_parameter = table.setdefault(name, {})
            for quantity, value in row(point, rate, piece.changes[name].length).items():
                of_parameter.setdefault(quantity, []).append(value)
            if point is middle:
                of_parameter["largest_stretch"] = rate.largest_stretch
        if point is middle and curve and curve.is_in_space:
            with suppress(SingularMatrix):
                parts = lateral_rates(piece, point.state, point.slopes, piece.changes, rates)
                for name, columns in parts.items():
                    values = zip(ACROSS, columns, strict=True)
                    table[name] |= {field: (part * getattr(curve, field)).tolist() for field, part in values}
    return table


def law_rates(
    config: Config,
    repetition: Repetition,
    movements: Mapping[str, Movement | DesignError],
    cells: Sequence[KeptCurve[CellCurve]],
    clamps: Sequence[KeptCurve[ClampCurve]],
) -> dict[str, LawRate]:
    """The derivatives of a law by parameter."""
    values = {name: (step.value, step.unit) for name, step in material_steps(config).items()}
    values |= {name: (value, measured.unit) for name, (value, measured) in config.effects.constants.items()}
    values |= {f"geometry.{name}": (value, "mm") for name, value in config.design.dimensions.items()}
    values |= dict.fromkeys(SCALES, (1.0, "1"))
    rates = {}
    for name in cells[0].rates:
        of_cells = tuple(CellRate(**{key: np.array(row) for key, row in cell.rates[name].items()}) for cell in cells)
        lengths = _lengths(config.design, name, repetition, movements)
        ends = tuple(
            _clamp_rate(clamp, cell.curve, of_cell, name)
            for clamp, cell, of_cell in zip(clamps, cells, of_cells, strict=True)
        )
        rates[name] = LawRate(*values[name], *lengths, of_cells, ends)
    return rates


def _lengths(
    design: Design, name: str, repetition: Repetition, movements: Mapping[str, Movement | DesignError]
) -> tuple[float, float, float]:
    """Changes of the pitch, of the first middle and of the length of the arm, mm per unit."""
    key = name.removeprefix("geometry.")
    movement = movements.get(key)
    if name == SCALES[0]:
        return 2.0 * repetition.half_pitch, repetition.middle, design.length
    if not name.startswith("geometry.") or not isinstance(movement, Movement):
        return 0.0, 0.0, 0.0
    value = design.dimensions[key]
    less, more = (design.with_dimension(key, value + change).length for change in (-CHANGE * value, CHANGE * value))
    longer = (more - less) / (2.0 * CHANGE * value)
    return 2.0 * (movement.edge - movement.middle), movement.middle, longer


def _clamp_rate(clamp: KeptCurve[ClampCurve], cell: CellCurve, rate: CellRate, name: str) -> ClampRate:
    """How the clamped end departs from cells continued to it, whose curvature and stretch change as well."""
    curve, of_end = clamp.curve, {key: np.array(value) for key, value in clamp.rates[name].items()}
    by_moment = -rate.moment / cell.rigidity  # curvature of the cell, at fixed moment
    stretches = rate.stretch + cell.stretch_by_kappa * by_moment
    ripples = rate.ripple[:, 1] + parabola_slopes(cell.kappa, cell.ripple[:, -1]) * by_moment[:, None]
    rotations, offsets = [], []
    for k, moment in enumerate(curve.moment):
        kappa, stretch, ripple = cell.at(float(moment))
        curvature, longer, *bulge = (
            float(cubic(cell.moment, values, slopes_of(cell, cell.moment, values), float(moment)))
            for values in (by_moment, stretches, *ripples.T)
        )
        length, height = float(curve.s[-1]), float(of_end["height"][k])
        angle = float(curve.rotation[k]) + kappa * length
        now = np.array([angle, float(curve.rotation[k]), kappa, stretch, length, *ripple])
        turned, lengthened = float(of_end["angle"][k]), float(of_end["length"][k])
        rotation = turned - curvature * length - kappa * lengthened
        change = np.array([turned, rotation, curvature, longer, lengthened, *bulge])
        ahead, behind = (_axis_end(*(now + sign * DIFFERENCE * change)) for sign in (1.0, -1.0))
        rotations.append(rotation)
        offsets.append(of_end["end"][k] - (ahead - behind) / (2.0 * DIFFERENCE) - [0.0, height])
    return ClampRate(np.array(rotations), np.array(offsets))


def _axis_end(angle: float, rotation: float, kappa: float, stretch: float, length: float, *ripple: float) -> Array:
    """(2,) mm: the end of the material curve of cells that begin at the clamp, beside the end of their axis.

    angle: of the plane; rotation: at the clamp, rad; curvature in 1/mm, length and ripple in mm.
    """
    x, y = circle(np.array([length]), stretch, kappa)[0]
    cosine, sine = np.cos(rotation), np.sin(rotation)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    return np.array([cosine * x - sine * y, sine * x + cosine * y]) + ripple[0] * along + ripple[1] * normal


@dataclass(frozen=True)
class MaterialStep:
    """The materials of a body with a constant smaller and larger by half a step."""

    value: float
    unit: str  #: MPa, or 1
    step: float
    less: fem.Solid
    more: fem.Solid


def material_steps(config: Config) -> dict[str, MaterialStep]:
    """Steps of constants by their keys: material.E, materials.base.mu, or material.mu.2 for the second of a list."""
    steps = {}
    for region, material in {"": config.material, **config.materials}.items():
        section = f"materials.{region}" if region else "material"
        for name, value, unit, half, less, more in _constants(material):
            solids = (_solid(config, region, changed) for changed in (less, more))
            steps[f"{section}.{name}"] = MaterialStep(value, unit, 2.0 * half, *solids)
    return steps


def _constants(material: Material) -> Iterator[tuple[str, float, str, float, Material, Material]]:
    """Name, value, unit, half the step, and the material with less and with more of it."""
    for name, kind in LAWS[material.law].constants().items():
        given = material.constants[name]
        values = given if isinstance(given, tuple) else (given,)
        for k, value in enumerate(values):
            half = _change(material, kind, value)
            several = [(*values[:k], value + change, *values[k + 1 :]) for change in (-half, half)]
            less, more = (
                replace(material, constants={**material.constants, name: new if isinstance(given, tuple) else new[0]})
                for new in several
            )
            key = f"{name}.{k + 1}" if isinstance(given, tuple) else name
            yield key, value, kind.unit.strip() or "1", half, less, more


def _change(material: Material, kind: Constant, value: float) -> float:
    if kind is Constant.POISSON_RATIO:
        return STEP_OF_CONSTANT * min(abs(value) or 0.5, 0.5 - value)
    if kind in (Constant.STRESS, Constant.STRESSES):
        return STEP_OF_CONSTANT * material.built().shear_modulus
    return STEP_OF_CONSTANT * abs(value)


def _solid(config: Config, region: str, material: Material) -> fem.Solid:
    materials = {name: other.built() for name, other in config.materials.items()}
    body = config.material.built()
    if region:
        return fem.ByRegion(body, {**materials, region: material.built()})
    return fem.ByRegion(material.built(), materials) if materials else material.built()
