"""Where a run gives its rod two lines, and where a single one."""

from types import SimpleNamespace
from typing import Any

import pytest

from pipeline.identify import mesh_error
from pipeline.identify import parameters as identification
from pipeline.identify.parameters import Parameters, counts_as_equal_cells, identify_all, sum_evidence, takes_two_lines


@pytest.mark.parametrize(
    ("evidence", "one_rigidity", "given_d", "two_lines", "is_clear"),
    [
        (20.0, False, None, True, True),
        (-20.0, False, None, False, True),
        (3.0, False, None, True, False),
        (20.0, True, None, False, True),
        (3.0, True, None, False, True),
        (-20.0, True, 12.0, True, True),
    ],
)
def test_two_lines_need_a_cause_or_a_given_break(
    evidence: float, one_rigidity: bool, given_d: float | None, two_lines: bool, is_clear: bool
) -> None:
    owner: Any = SimpleNamespace(evidence=evidence, one_rigidity=one_rigidity, given_d=given_d)
    assert Parameters.two_lines.fget(owner) is two_lines  # type: ignore[attr-defined]
    assert Parameters.choice_is_clear.fget(owner) is is_clear  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("evidence", "one_rigidity", "together", "two_lines"),
    [
        ([-2.9, 49.8], [False, False], [46.9, 46.9], [True, True]),
        ([-9.0, 4.0, 20.0], [True, False, False], [-9.0, 24.0, 24.0], [False, True, True]),
        ([8.0, -3.0], [True, False], [8.0, -3.0], [False, False]),
    ],
)
def test_the_pressures_at_which_walls_touch_decide_together(
    evidence: list[float], one_rigidity: list[bool], together: list[float], two_lines: list[bool]
) -> None:
    decisive = sum_evidence(evidence, one_rigidity)
    assert decisive == pytest.approx(together)
    for of_pressure, is_one, expected in zip(decisive, one_rigidity, two_lines, strict=True):
        assert takes_two_lines(of_pressure, is_one, d_given=False) is expected
        assert takes_two_lines(of_pressure, is_one, d_given=True)


@pytest.mark.parametrize(
    ("repeats", "within", "equal"), [(True, False, True), (False, False, False), (False, True, True)]
)
def test_cells_that_are_longer_than_the_average_count_as_equal(repeats: bool, within: bool, equal: bool) -> None:
    design: Any = SimpleNamespace(repeats=repeats, averages_within_cavities=within)
    assert counts_as_equal_cells(design) is equal


@pytest.mark.parametrize("touching", ["", "II", "III"])
@pytest.mark.parametrize("equal_cells", [True, False])
def test_one_rigidity_holds_along_equal_cells_that_do_not_touch(
    touching: str, equal_cells: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the numbers themselves do not matter here
    monkeypatch.setattr(identification, "identify", lambda *given, **keys: SimpleNamespace(evidence=4.0))
    monkeypatch.setattr(identification, "cell_averaged", lambda *given, **keys: None)
    monkeypatch.setattr(identification, "_moment_and_closure", lambda *given: (None, None))
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
    assert identified.evidence == 4.0


@pytest.mark.parametrize("touching", [False, True])
@pytest.mark.parametrize("equal_cells", [False, True])
def test_a_coarser_mesh_decides_by_the_contact_of_its_own_states(
    touching: bool, equal_cells: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    line = SimpleNamespace(alpha=SimpleNamespace(value=1.0), m0=SimpleNamespace(value=0.0))
    identified = iter([SimpleNamespace(single_line=line, law=None, evidence=evidence) for evidence in (-3.0, 20.0)])
    monkeypatch.setattr(mesh_error, "numbers_of_curves", lambda *given: next(identified))
    monkeypatch.setattr(mesh_error, "cell_averaged", lambda *given: SimpleNamespace(middle=0.0))
    effects = ("self_contact",) if touching else ()
    record: Any = SimpleNamespace(effects=effects, centreline=None, load=None)
    fine: Any = SimpleNamespace(
        pressure_kPa=10.0,
        kappa=SimpleNamespace(pitch=10.0),
        given_d=None,
        shortest_break=5.0,
        two_lines=False,
        equal_cells=equal_cells,
    )
    outcome = SimpleNamespace(at=lambda pressure: record)

    class Outcomes(dict[str, Any]):
        failures = ()

    outcomes: Any = Outcomes(coarser_II=outcome, coarser_III=outcome)
    found, refused = mesh_error._identify((fine, fine), outcomes, "coarser")
    assert refused == []
    assert mesh_error._two_lines((fine, fine), found) == [touching or not equal_cells] * 2
