"""What limits the use of states and parameters."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry import Centreline, Reason
from pipeline.config.load import load_config
from pipeline.identify.state_notes import Solved, check_states
from pipeline.values.reasons import render
from rod import Interval
from rod.identification.two_lines import CLEAR

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"
YEOH = "material={law: yeoh, c10: 0.15 MPa, c20: 0 MPa, c30: 0 MPa, nu: 0.49%s}"
RUBBER = "material={law: neo_hooke, mu: 0.4 MPa, nu: 0.495}"


def solved(
    *settings: str,
    min_J: float = 0.95,
    stretches: tuple[float, float] = (0.95, 1.05),
    alpha2: tuple[float, float] = (9, 11),
    contact: tuple[float, float] = (np.nan, np.nan),
    inexact: tuple[Reason, ...] = (),
    evidence: float = 20.0,
    on_coarser: bool | None = None,
    one_rigidity: bool = False,
    curve_z_mm: float = 0.0,
    deflection_mm: float = -50.0,
    path_dependence: float = 0.0,
    r2: float = 0.9,
    share: float = 0.02,
    axis: str = "",
) -> Any:
    """A run with one state of II at 20 kPa and the parameters at this pressure.

    share: of the volume that has the stretches and J that are given; the rest is at rest.
    """
    low, high = stretches
    state = SimpleNamespace(
        experiment="II",
        pressure_kPa=20.0,
        min_J_at_mm=(1.0, 2.0, 3.0),
        curve_z_mm=curve_z_mm,
        end_rotation_deg=float(np.degrees(np.arctan2(deflection_mm, 100.0))),
        contact_error_mm=contact[0],
        contact_error_N=contact[1],
    )
    s = np.linspace(0.0, 100.0, 5)
    record = SimpleNamespace(
        state=state,
        fields={
            "stretch": np.array([high, 1.0, 1.0]),
            "smallest_stretch": np.array([1.0, low, 1.0]),
            "J": np.array([min_J, 1.0, 1.0]),
        },
        inexact=inexact,
        path_dependence=path_dependence,
        instability=(Reason("unstable", {"directions": 1, "axis": axis}),) if axis else (),
        pressure_kPa=20.0,
        experiment="II",
        centreline=Centreline(s, s, 1.0 + deflection_mm * s / 100.0),
    )
    lines = SimpleNamespace(
        evidence=evidence,
        alpha2=Interval(13.61, 0.1, 13.4, 13.8),
        single_line=SimpleNamespace(alpha=Interval(10.94, 0.5, 10.0, 12.0), r2=r2),
    )
    parameters = SimpleNamespace(
        pressure_kPa=20.0,
        numbers={"alpha1": Interval(10.0, 0.5, 9.0, 11.0), "alpha2": Interval(10.0, 0.5, *alpha2)},
        by_cells=lines,
        two_lines=evidence > 0.0 and not one_rigidity,
        evidence=evidence,
        choice_is_clear=one_rigidity or abs(evidence) >= CLEAR,
        two_lines_on_coarser=on_coarser,
    )
    config = load_config(CONFIGS / "pneunet_coarse.yaml", settings)
    return Solved(config, SimpleNamespace(records=(record,)), (parameters,), np.array([share, share, 1.0 - 2 * share]))  # type: ignore[arg-type]


def only(run: Solved) -> Reason:
    """The only reason, which can be written."""
    (reason,) = check_states(run)
    assert render(reason)
    json.dumps(reason.values, allow_nan=False)
    return reason


@pytest.mark.parametrize(
    ("settings", "state", "code"),
    [
        ((), {"axis": "y"}, "unstable_states"),
        ((), {"axis": "z"}, "unstable_states"),
        ((), {"min_J": 0.6}, "volume_lost_unevenly"),
        (("mesh.formulation=mixed", "material={law: svk, E: 1.2 MPa, nu: 0.49}"), {"min_J": 0.48}, "volume_lost"),
        ((), {"stretches": (0.95, 1.3)}, "beyond_law"),
        ((), {"stretches": (0.8, 1.05)}, "beyond_law"),
        (("material={law: neo_hooke, mu: 0.1 MPa, nu: 0.49}",), {"stretches": (0.8, 1.7)}, "beyond_law"),
        ((), {"deflection_mm": -1.0}, "hardly_bent"),
        ((), {"curve_z_mm": 1.12}, "out_of_plane"),
        (("effects.pressure=off",), {"curve_z_mm": 0.02, "deflection_mm": 0.012}, "out_of_plane"),
        ((), {"alpha2": (9.0, 37.0)}, "rigidity_open"),
        ((), {"alpha2": (0.0, 11.0)}, "rigidity_open"),
        ((), {"alpha2": (-40.0, 60.0)}, "rigidity_open"),
        ((), {"r2": 0.28, "evidence": -20.0}, "one_rigidity_poor"),
        ((), {"evidence": -0.77, "on_coarser": False}, "one_line_or_two"),
        ((), {"evidence": 10.7, "on_coarser": False}, "one_line_or_two"),
        ((), {"evidence": -7.6, "on_coarser": True}, "one_line_or_two"),
        ((), {"contact": (0.25, 0.01)}, "approximate_contact"),
        ((), {"inexact": (Reason("not_converged"),)}, "contact_not_compared"),
        ((), {"path_dependence": 0.081}, "path_dependent_contact"),
        ((), {"path_dependence": inf}, "folded_contact_open"),
    ],
)
def test_unusual_states_and_parameters(settings: tuple[str, ...], state: dict[str, Any], code: str) -> None:
    assert only(solved(*settings, **state)).code == code


@pytest.mark.parametrize(
    ("settings", "state"),
    [
        ((), {}),
        ((), {"min_J": 0.5, "stretches": (0.7, 1.4), "share": 0.005}),  # one corner
        (("mesh.formulation=mixed",), {"min_J": 0.95}),
        (("mesh.formulation=mixed", "material={law: svk, E: 1.2 MPa, nu: 0.45}"), {"min_J": 0.6}),
        ((RUBBER,), {"stretches": (0.5, 1.45)}),
        ((), {"curve_z_mm": 0.1}),
        ((), {"curve_z_mm": 0.15, "deflection_mm": -60.0}),  # an unsymmetric mesh of a symmetric body
        ((), {"r2": 0.51, "evidence": -20.0}),
        ((), {"r2": 0.28, "evidence": 20.0}),
        ((), {"evidence": 6.1, "on_coarser": True}),
        ((), {"evidence": -6.1, "on_coarser": False}),
        ((), {"evidence": 1.0, "one_rigidity": True}),
        ((), {"contact": (0.0, 0.0)}),
        (("effects.pressure=off",), {"deflection_mm": -1.0}),
    ],
)
def test_usual_states_and_parameters(settings: tuple[str, ...], state: dict[str, Any]) -> None:
    assert check_states(solved(*settings, **state)) == ()


def test_an_arm_that_is_held_in_its_middle_is_as_much_in_its_plane_as_the_free_one() -> None:
    """An unsymmetric mesh moves both by 0.15 mm across; the held end hardly moves in the plane."""
    run, held = solved(curve_z_mm=0.15, deflection_mm=-60.0), solved(curve_z_mm=0.15, deflection_mm=-1.0)
    (record,) = held.outcomes.records
    record.experiment = record.state.experiment = "III"
    run.outcomes.records += held.outcomes.records
    assert check_states(run) == ()


def test_reasons_have_the_numbers_of_the_states() -> None:
    at = {"experiment": "II", "pressure_kPa": 20.0}
    lost = only(solved(min_J=0.6))
    assert (lost.values, lost.where) == ({"percent": pytest.approx(40.0), "share": 1.0, **at}, (1.0, 2.0, 3.0))
    assert only(solved(curve_z_mm=1.12)).values == {"distance_mm": 1.12, "deflection_mm": 50.0, **at}
    bend = np.degrees(np.arctan(0.01))
    assert only(solved(deflection_mm=-1.0)).values == {"pressure_kPa": 20.0, "bend_deg": pytest.approx(bend)}
    assert only(solved(r2=0.28, evidence=-20.0)).values == {"r2": 0.28, "pressure_kPa": 20.0}
    assert only(solved(contact=(0.25, 0.01))).values == {"end_mm": 0.25, "end_N": 0.01, **at}
    assert only(solved(path_dependence=0.081)).values == {"percent": pytest.approx(8.1), **at}
    open_at = only(solved(alpha2=(9.0, 37.0))).values
    assert open_at == {"rigidity": "α₂", "low": 9.0, "high": 37.0, "pressure_kPa": 20.0}
    either = only(solved(evidence=-0.77)).values
    assert either == {"pressures_kPa": [20.0], "single_N_mm2": 10.94, "two_N_mm2": 13.61}


@pytest.mark.parametrize(
    ("law", "stretches", "holds"),
    [
        ("material={law: hencky, E: 1.2 MPa, nu: 0.495}", (0.75, 1.2), None),
        ("material={law: hencky, E: 1.2 MPa, nu: 0.495}", (0.65, 1.2), (0.7, 1.3)),
        ("material={law: hencky, E: 1.2 MPa, nu: 0.495}", (0.95, 1.35), (0.7, 1.3)),
        ("material={law: neo_hooke, mu: 0.4 MPa, nu: 0.495}", (0.6, 1.6), (0.0, 1.5)),
        ("material={law: mooney_rivlin, c10: 0.2 MPa, c01: 0.02 MPa, nu: 0.495}", (0.7, 1.8), (0.0, 1.7)),
        (
            "material={law: mooney_rivlin, c10: -0.05 MPa, c01: 0.1 MPa, nu: 0.49}",
            (0.9, 1.65),
            (0.0, 1.35),
        ),  # unstable beyond
        ("material={law: yeoh, c10: 0.2 MPa, c20: 0.01 MPa, c30: 0 MPa, nu: 0.495}", (0.5, 2.0), None),
        (YEOH % "", (0.7, 1.9), None),
        (YEOH % ", holds_between: [0.75, 1.8]", (0.7, 1.9), (0.75, 1.8)),
        (YEOH % ", holds_between: [0.6, 2]", (0.7, 1.9), None),
    ],
)
def test_stretches_beyond_those_for_which_a_law_holds(
    law: str, stretches: tuple[float, float], holds: tuple[float, float] | None
) -> None:
    run = solved(law, stretches=stretches)
    if holds is None:
        assert check_states(run) == ()
        return
    values = only(run).values
    assert (values["part"], values["law"]) == ("the walls", run.config.material.law)
    assert (values["smallest"], values["largest"], values["pressure_kPa"]) == (*stretches, 20.0)
    assert (values["holds_from"], values["holds_to"]) == pytest.approx(holds, abs=0.005)


def test_the_law_of_a_region_is_compared_with_the_stretches_in_it() -> None:
    run = solved(YEOH % "", "materials={base: {law: svk, E: 0.3 MPa, nu: 0.49}}", stretches=(0.5, 1.4))
    low, high = np.array([0.5, 0.95, 0.57]), np.array([1.4, 1.05, 1.08])
    run.outcomes.records[0].fields = {"smallest_stretch": low, "stretch": high, "J": np.ones(3)}
    values = only(replace(run, regions={"base": np.array([1, 2])})).values
    assert (values["part"], values["smallest"], values["largest"]) == ("the part base", 0.57, 1.08)
    assert check_states(replace(run, regions={"base": np.array([1])})) == ()


def test_few_pressures_that_are_left_of_several() -> None:
    run = solved("pressures=[20 kPa, 60 kPa, 75 kPa]")
    assert only(run).values == {"count": 1, "given": 3}
    assert only(replace(run, parameters=2 * run.parameters)).values["count"] == 2
    assert check_states(replace(run, parameters=3 * run.parameters)) == ()
    assert check_states(replace(run, config=solved("pressures=[20 kPa]").config)) == ()
