"""CAD bodies without their small fillets, dimples, steps and letters."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, bar
from tests.step_bodies import box, save

#: volumes (mm3) of the letters, of the step on one side, and of a dimple
LETTER, STEP, DIMPLE = 1.5 * 2 * 0.1, 20 * 6 * 0.05, np.pi * 0.25**2 * 0.3


def with_details(occ: Any) -> Any:
    """The bar with a raised letter and a dimple on either side of the middle, and a step on one side of it."""
    solids = bar(occ)
    letters = [box(occ, (10, 11.5, z), (11.5, 12.1, z + 2)) for z in (-3, 1)]
    solids = occ.fuse(solids, [*letters, box(occ, (30, 2, 7), (50, 8, 7.55))])[0]
    dimples = [(3, occ.addCylinder(20, 12, z, 0, -0.3, 0, 0.25)) for z in (-2, 2)]
    return occ.cut(solids, dimples)[0]


def rounded(occ: Any) -> Any:
    """The bar with all edges, outside and in the cavity, rounded by 0.3 mm."""
    ((_, solid),) = bar(occ)
    occ.synchronize()
    return occ.fillet([solid], [tag for _, tag in occ.getEntities(1)], [0.3])


def standing(occ: Any) -> Any:
    """The bar with details with its length along z, in inches, clamped at its larger end."""
    solids = with_details(occ)
    occ.rotate(solids, 0, 0, 0, 0, 1, 0, -np.pi / 2)
    occ.dilate(solids, 0, 0, 0, 1 / 25.4, 1 / 25.4, 1 / 25.4)
    return solids


@pytest.mark.parametrize("draw", [with_details, rounded])
def test_without_its_details_the_bar_is_left(tmp_path: Path, draw: Any) -> None:
    path = save(tmp_path / "body.step", draw)
    design = CadFile(str(path), 1.5, defeature=0.8)
    assert (design.extent, len(design.edges)) == (pytest.approx((60, 12, 15)), 24)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)
    assert design.cavity_volumes == pytest.approx({"cavity": BAR_AIR}, rel=1e-9)
    quality = design.body(5.0).mesh.quality
    given = CadFile(str(path), 1.5, symmetric=draw is rounded)
    assert given.solid_volume != pytest.approx(BAR_VOLUME, rel=1e-6)
    assert quality.count < given.body(5.0).mesh.quality.count / 2


def test_only_what_is_narrower_is_removed(tmp_path: Path) -> None:
    """The width of the sides of letters and step is 0.05 and 0.1 mm, that of the dimples 0.25 mm."""
    path = save(tmp_path / "body.step", with_details)
    volumes = [CadFile(str(path), 1.5, symmetric=False, defeature=length).solid_volume for length in (0.07, 0.12, 0.3)]
    expected = [BAR_VOLUME + 2 * LETTER - 2 * DIMPLE, BAR_VOLUME - 2 * DIMPLE, BAR_VOLUME]
    assert volumes == pytest.approx(expected, rel=1e-8)
    assert CadFile(str(path), 1.5, symmetric=False).solid_volume == pytest.approx(expected[0] + STEP, rel=1e-8)


def test_the_length_is_in_mm_whatever_unit_and_directions_the_file_has(tmp_path: Path) -> None:
    path = save(tmp_path / "body.brep", standing)
    design = CadFile(str(path), 1.5, unit=25.4, axes=("z", "y", "-x"), clamp=60, tip=0, defeature=0.8)
    assert (design.extent, len(design.edges)) == (pytest.approx((60, 12, 15)), 24)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)


def test_what_cannot_be_removed_stays(tmp_path: Path) -> None:
    """The ring between two round parts of different radius, which do not meet however far they are extended."""

    def stepped(occ: Any) -> Any:
        parts = [(3, occ.addCylinder(0, 0, 0, 30, 0, 0, 7.0)), (3, occ.addCylinder(30, 0, 0, 30, 0, 0, 6.9))]
        return occ.cut(occ.fuse(parts[:1], parts[1:])[0], [box(occ, (3, -2, -4), (57, 3, 4))])[0]

    path = save(tmp_path / "body.step", stepped)
    given, design = CadFile(str(path), -3.0), CadFile(str(path), -3.0, defeature=0.3)
    assert design.solid_volume == pytest.approx(given.solid_volume, rel=1e-9)
    assert [edge for edge, _ in design.edges] == pytest.approx([edge for edge, _ in given.edges])


@pytest.mark.parametrize(
    ("given", "keys", "sentence"),
    [
        ({"defeature": -0.1}, ("defeature",), "must be a positive length, not -0.1"),
        ({"defeature": 1.6}, ("defeature",), "1.6 mm is more than half of the thinnest wall, 2.0"),
        ({"defeature": 0.1, "parts": {"base": (1, 1, 1)}}, ("parts", "defeature"), "narrow faces are removed from one"),
    ],
)
def test_refusals(tmp_path: Path, given: dict[str, Any], keys: tuple[str, ...], sentence: str) -> None:
    path = save(tmp_path / "body.step", bar)
    with pytest.raises(DesignError) as caught:
        CadFile(str(path), 1.5, **given)
    assert caught.value.keys == keys
    assert sentence in caught.value.sentence


def test_a_length_that_changes_the_volume_is_refused(tmp_path: Path) -> None:
    def ribbed(occ: Any) -> Any:
        ribs = [box(occ, (5 + 3 * k, 11, -7.5), (5.7 + 3 * k, 12.7, 7.5)) for k in range(17)]
        return occ.fuse(bar(occ), ribs)[0]

    path = save(tmp_path / "body.step", ribbed)
    with pytest.raises(DesignError, match=r"the volume of the material changes by -1\.\d %, and at most 1 % are"):
        CadFile(str(path), 1.5, defeature=0.9)
