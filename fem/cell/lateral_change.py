"""Derivatives of the rigidities of a cell out of its plane by its design, at a fixed curvature.

They are differences to one side: of a cell with a little more of the parameter, in the planar state that it then has to
first order, and of the cell itself. So a parameter takes no further equilibrium, and two factorizations.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fem.cell.design_change import DesignChange, DesignRate, Variant, moved_term
from fem.cell.lateral import LateralRigidities, lateral_rigidities
from fem.cell.piece import BendingPiece, PieceState
from fem.cell.response import Slopes
from fem.equations.state import State
from geometry.arrays import Array


def lateral_rates(
    piece: BendingPiece,
    at: PieceState,
    known: Slopes,
    changes: Mapping[str, DesignChange],
    rates: Mapping[str, DesignRate],
) -> dict[str, tuple[float, float]]:
    """Derivatives of B_2 and GJ by parameter over B_2 and GJ, per unit of it.

    rates: of this state, with those of the displacement. Raises `fem.equations.linear.SingularMatrix`.
    """
    if not changes:
        return {}
    u = at.state.displacement
    own = _rigidities(piece, at, Variant(piece.space, piece.system.formulation, 1.0), u)
    result = {}
    for name, change in changes.items():
        step, rate = 0.5 * change.step, rates[name]
        turn = at.angle / piece.body.length * change.length
        moved = rate.moved + turn * known.by_angle
        moved[piece.plane] -= change.velocity[piece.plane]
        moment = at.moment + step * (rate.moment + turn * known.moment_by_angle)
        state = replace(at, angle=at.angle + step * turn, moment=moment)
        more = _rigidities(piece, state, change.more, u + step * moved)
        bending, torsion = more.bending / own.bending - 1.0, more.torsion / own.torsion - 1.0
        result[name] = bending / step, torsion / step
    return result


def _rigidities(piece: BendingPiece, at: PieceState, variant: Variant, displacement: Array) -> LateralRigidities:
    """Of a variant with this displacement (n, 3); at: its angle, moment and pressure, with the terms of the piece."""
    space, formulation = variant.space, variant.formulation
    strain, _ = space.strain_of(displacement)
    pressure = formulation.pressure_of(strain)
    stress = formulation.evaluate(strain, pressure).stress
    end = (space.points + displacement)[piece.plane[0]]
    moved = replace(
        at,
        distance=float(end @ (np.cos(at.angle), np.sin(at.angle), 0.0)),
        state=State(at.state.factor, displacement, pressure, strain, stress),
        terms=tuple(moved_term(term, piece.space.points, variant) for term in at.terms),
    )
    return lateral_rigidities(piece.varied(space, formulation), moved)
