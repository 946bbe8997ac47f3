"""The limits of the pressure of a cell as values, and a law that ends below one."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.config.load import load_config
from pipeline.law.build import deliver_law
from pipeline.law.piece.pieces import ArmPieces
from pipeline.law.piece.tasks import ArmTasks, Log
from pipeline.law.snap import (
    LIMIT,
    RETURN,
    Snap,
    SnapLimits,
    elements_differ,
    find_snap,
    rising_pressures,
    swollen_pieces,
)
from pipeline.simulate.scene import Scene
from tests.snapping_arm import snapping_law
from tests.solved import alone

ARM = Path(__file__).resolve().parents[2] / "data" / "moseley_c5w7.yaml"
RUBBER = "material={law: neo_hooke, mu: 0.01877 MPa, kappa: 1.87 MPa, density: 1070 kg/m^3}"


def snap(size: float, *, returns: bool = True) -> Snap:
    """Whose pressures grow with the square of the size of the mesh."""
    pressures = {LIMIT: 27.0 + 0.1 * size**2} | ({RETURN: 22.0 + 0.1 * size**2} if returns else {})
    return Snap(pressures, {LIMIT: {"geometry.wall": 4.0}}, [27.0, 25.0, 22.0], [-0.01, -0.02, -0.03])


def test_the_limits_are_those_of_an_infinitely_fine_mesh() -> None:
    limits = SnapLimits.of(snap(2.0), {size: snap(size) for size in (2.0, 1.4, 1.0)})
    for name, true in ((LIMIT, 27.0), (RETURN, 22.0)):
        value, std = limits.found[name]
        assert std is not None
        assert value == pytest.approx(true, abs=max(2.0 * std, 0.02))
    law = limits.on(snapping_law(swells=False), Log(), [15.0])
    assert law.limit.rates == {"geometry.wall": 4.0}
    np.testing.assert_allclose(law.limit.kappas, [-0.01, -0.02, -0.03])
    on_one = SnapLimits.of(snap(2.0), {2.0: snap(2.0), 1.4: snap(1.4, returns=False)})
    assert on_one.found[LIMIT] == (27.4, None)


def test_each_form_has_its_own_pressures() -> None:
    limits = SnapLimits.of(snap(0.0), {})
    assert rising_pressures([15.0, 24.0, 30.0], limits) == [15.0, 24.0, 25.65, 26.46]
    assert rising_pressures([15.0, 24.0], limits) == [15.0, 24.0]
    assert rising_pressures([15.0, 30.0], SnapLimits()) == [15.0, 30.0]
    config = load_config(ARM, ["pressures=[15 kPa, 24 kPa, 30 kPa]"])
    law = snapping_law(swells=False)
    pieces = swollen_pieces(ArmPieces.of(Scene.meshed(config)), limits.on(law, Log(), [15.0]))
    assert pieces.after_snap
    assert pieces.config.pressures_kPa == (22.44, 24.0, 27.54, 30.0)
    assert pieces.with_mesh_size(3.0).after_snap
    assert swollen_pieces(pieces, law) is None


def test_a_law_of_an_arm_without_a_form_beyond_ends_below_its_limit(tmp_path: Path) -> None:
    settings = [RUBBER, "pressures=[20 kPa, 30 kPa]", "mesh.size=6 mm", "draft=true"]
    config = load_config(ARM, settings)
    with alone(tmp_path, config) as context:
        measured = deliver_law(ArmPieces.of(Scene.meshed(config)), context)
    law = measured.law
    assert config.effects.strain_limiting_layer.on
    assert measured.layers is None  # the swollen arm is not solved without its sheet, which takes minutes
    assert law.limit.value == pytest.approx(26.9, rel=0.05)
    assert (law.back, law.swollen, law.limit.std) == (None, None, None)
    assert law.pressures[:2] == (0.0, 20.0)
    assert 20.0 < law.pressures[-1] < law.limit.value
    (failure,) = measured.failures
    assert "beyond its limit pressure" in str(failure.values["why"])


def test_elements_taken_by_hand_whose_limit_differs_from_mixed_ones_are_named(tmp_path: Path) -> None:
    settings = [RUBBER, "pressures=[20 kPa, 33 kPa]", "mesh.size=6 mm", "mesh.formulation=p2p0", "draft=true"]
    config = load_config(ARM, settings)
    with alone(tmp_path, config) as context:
        tasks = ArmTasks(ArmPieces.of(Scene.meshed(config)), context)
        limit = find_snap(tasks, 33.0).limit
        (reason,) = elements_differ(tasks, limit, 33.0)
        assert limit is not None
        assert reason.values["soft"] == f"{limit:.4g} kPa"
        mixed = float(str(reason.values["mixed"]).removesuffix(" kPa"))
        assert abs(mixed / limit - 1.0) > 0.01
        assert elements_differ(tasks, mixed, 33.0) == []
        (reason,) = elements_differ(tasks, None, 33.0)
    assert reason.values["soft"] == "above 33 kPa"
