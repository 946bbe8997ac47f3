"""Where a run gives its rod two lines, and where a single one."""

from types import SimpleNamespace
from typing import Any

import pytest

from pipeline.identification import mesh_error
from pipeline.identification import parameters as identification
from pipeline.identification.parameters import Parameters, identify_all


def lines(two_lines: bool, d_given: bool = False) -> Any:
    return SimpleNamespace(two_lines=two_lines or d_given, d_given=d_given)


@pytest.mark.parametrize(
    ("one_rigidity", "identified", "two_lines"),
    [
        (False, lines(True), True),
        (False, lines(False), False),
        (True, lines(True), False),
        (True, lines(False), False),
        (True, lines(False, d_given=True), True),
    ],
)
def test_two_lines_need_a_cause_or_a_given_break(one_rigidity: bool, identified: Any, two_lines: bool) -> None:
    owner: Any = SimpleNamespace(one_rigidity=one_rigidity)
    assert Parameters.has_two_lines(owner, identified) is two_lines


@pytest.mark.parametrize("touching", ["", "II", "III"])
@pytest.mark.parametrize("equal_cells", [True, False])
def test_one_rigidity_holds_along_equal_cells_that_do_not_touch(
    touching: str, equal_cells: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the numbers themselves do not matter here
    for name in ("cell_averaged", "shared_smoothing", "gaussian_process", "identify", "moment_from_load", "extension"):
        monkeypatch.setattr(identification, name, lambda *given, **keys: None)
    monkeypatch.setattr(identification, "_moment_and_closure", lambda *given: (None, None))
    monkeypatch.setattr(identification, "_closest_rod", lambda *given: None)
    monkeypatch.setattr(identification, "LoadedShape", lambda *given: None)
    free, loaded = (
        SimpleNamespace(
            pressure_kPa=10.0,
            centreline=None,
            load=None,
            held=(False, False),
            effects=("pressure", "self_contact") if name == touching else ("pressure",),
        )
        for name in ("II", "III")
    )
    outcomes: Any = SimpleNamespace(pairs=[(free, loaded)])
    ((identified,), refused) = identify_all(outcomes, 10.0, equal_cells=equal_cells)
    assert refused == ()
    assert identified.one_rigidity is (equal_cells and not touching)


@pytest.mark.parametrize("touching", [False, True])
@pytest.mark.parametrize("equal_cells", [False, True])
def test_a_coarser_mesh_decides_by_the_contact_of_its_own_states(
    touching: bool, equal_cells: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = SimpleNamespace(alpha=SimpleNamespace(value=1.0), m0=SimpleNamespace(value=0.0))
    identified = SimpleNamespace(single_line=line, law=None, two_lines=True, d_given=False)
    monkeypatch.setattr(mesh_error, "numbers_of_cells", lambda *given: identified)
    monkeypatch.setattr(mesh_error, "_measured", lambda *given: {})
    monkeypatch.setattr(mesh_error, "PARAMETER_NAMES", ())
    record: Any = SimpleNamespace(effects=("self_contact",) if touching else ())
    fine: Any = SimpleNamespace(
        kappa=SimpleNamespace(pitch=10.0), given_d=None, shortest_break=5.0, two_lines=False, equal_cells=equal_cells
    )
    coarser = mesh_error._on_coarser(fine, record, record)
    assert coarser is not None
    assert coarser.two_lines is (touching or not equal_cells)
