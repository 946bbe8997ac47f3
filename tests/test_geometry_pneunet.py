import numpy as np
import pytest

from geometry import PneuNet


@pytest.mark.parametrize("design", [PneuNet(), PneuNet(chambers=1), PneuNet(chambers=2, wall=1.5, channel=1, gap=3)])
def test_half_mesh_has_the_closed_form_volumes(design: PneuNet) -> None:
    mesh = design.body(6).mesh
    assert 2 * mesh.volume == pytest.approx(design.solid_volume, rel=1e-12)
    assert 2 * mesh.enclosed_volume("cavity") == pytest.approx(design.cavity_volume, rel=1e-12)


def test_curve_runs_from_clamp_to_tip() -> None:
    body = PneuNet().body(4)
    curve = body.mesh.points[body.curve_vertices]
    assert (curve[:, 1:] == [1, 0]).all()
    assert curve[0, 0] == 0
    assert curve[-1, 0] == pytest.approx(112, abs=1e-12)
    assert np.diff(curve[:, 0]).max() <= 4
