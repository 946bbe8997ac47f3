"""CAD bodies without their small fillets, dimples, steps and letters."""

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry import CadFile, DesignError
from pipeline.config.load import load_config
from tests.foreign_bodies import BAR_AIR, BAR_VOLUME, INLET, bar, bar_with_inlet, two_solids
from tests.step_bodies import box, in_inches, save

#: volumes (mm3) of the letters, of the step on one side, and of a dimple
LETTER, STEP, DIMPLE = 1.5 * 2 * 0.1, 20 * 6 * 0.05, np.pi * 0.25**2 * 0.3

#: corners of a block whose upper 0.1 mm are a letter on the bar
ON_TOP = (10, 11.5, -1), (11.5, 12.1, 1)


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


def standing_in_inches(folder: Path) -> Path:
    """A BREP file of the bar with details, with its length along z, clamped at its larger end."""

    def standing(occ: Any) -> Any:
        solids = with_details(occ)
        occ.rotate(solids, 0, 0, 0, 0, 1, 0, -np.pi / 2)
        return solids

    return in_inches(standing, folder / "inches.brep")


@pytest.mark.parametrize("draw", [with_details, pytest.param(rounded, marks=pytest.mark.slow)])
def test_without_its_details_the_bar_is_left(tmp_path: Path, draw: Any) -> None:
    path = save(tmp_path / "body.step", draw)
    design = CadFile(str(path), 1.5, defeature=0.8)
    assert (design.extent, len(design.edges)) == (pytest.approx((60, 12, 15)), 24)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)
    assert design.cavity_volumes == pytest.approx({"cavity": BAR_AIR}, rel=1e-9)
    given = CadFile(str(path), 1.5, symmetric=draw is rounded)
    assert given.solid_volume != pytest.approx(BAR_VOLUME, rel=1e-6)
    assert given.edges[0][0] < 0.6 < 5.0 < design.edges[0][0]


def test_without_its_details_the_bar_has_fewer_and_better_elements(tmp_path: Path) -> None:
    path = str(save(tmp_path / "body.step", with_details))
    without, given = (
        CadFile(path, 1.5, symmetric=False, cell=6.0, defeature=length).body(5.0).mesh.quality for length in (0.8, None)
    )
    assert without.count < 0.85 * given.count
    assert without.minimum > 2.0 * given.minimum


def test_only_what_is_narrower_is_removed(tmp_path: Path) -> None:
    """The width of the sides of letters and step is 0.05 and 0.1 mm, that of the dimples 0.25 mm."""
    path = save(tmp_path / "body.step", with_details)
    volumes = [CadFile(str(path), 1.5, symmetric=False, defeature=length).solid_volume for length in (0.07, 0.12, 0.3)]
    expected = [BAR_VOLUME + 2 * LETTER - 2 * DIMPLE, BAR_VOLUME - 2 * DIMPLE, BAR_VOLUME]
    assert volumes == pytest.approx(expected, rel=1e-8)
    assert CadFile(str(path), 1.5, symmetric=False).solid_volume == pytest.approx(expected[0] + STEP, rel=1e-8)


@pytest.mark.parametrize("ends", [{}, {"clamp": 60}, {"clamp": 60, "tip": 0}])
def test_the_length_is_in_mm_whatever_unit_and_directions_the_file_has(tmp_path: Path, ends: dict[str, float]) -> None:
    path = standing_in_inches(tmp_path)
    design = CadFile(str(path), 1.5, unit=25.4, axes=("z", "y", "-x"), defeature=0.8, **ends)
    assert (design.extent, len(design.edges)) == (pytest.approx((60, 12, 15)), 24)
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-6)


def test_of_one_half_the_other_has_no_details_either(tmp_path: Path) -> None:
    def half(occ: Any) -> Any:
        return occ.intersect(with_details(occ), [box(occ, (-1, -1, 0), (61, 20, 9))])[0]

    design = CadFile(str(save(tmp_path / "body.step", half)), 1.5, defeature=0.8, symmetric=True)
    assert design.extent == pytest.approx((60, 12, 15))
    assert design.solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)


def across(occ: Any) -> Any:
    """The bar with a rib and a groove across its top."""
    solids = occ.fuse(bar(occ), [box(occ, (10, 11, -7.5), (12, 12.1, 7.5))])[0]
    return occ.cut(solids, [box(occ, (40, 11.9, -8), (42, 13, 8))])[0]


def ring_and_ledge(occ: Any) -> Any:
    """The bar with a square ring on its top, and a ledge between it and a second bar, which stays."""
    ring = occ.cut([box(occ, (10, 11.5, -3), (16, 12.1, 3))], [box(occ, (12, 11, -1), (14, 13, 1))])[0]
    return occ.fuse(bar(occ), [*ring, box(occ, (20, 11, -7.5), (60, 12.05, 7.5))])[0]


@pytest.mark.parametrize(("draw", "volume"), [(across, BAR_VOLUME), (ring_and_ledge, BAR_VOLUME + 40 * 0.05 * 15)])
def test_what_runs_across_the_body_is_tried_as_well(tmp_path: Path, draw: Any, volume: float) -> None:
    design = CadFile(str(save(tmp_path / "body.step", draw)), 1.5, defeature=0.3)
    assert design.solid_volume == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize("halves", [False, True])
def test_a_hole_goes_however_its_cylinder_is_divided(tmp_path: Path, halves: bool) -> None:
    """The width of a hole through the base, of 0.1 mm radius and 3 mm depth, is 0.30 mm."""

    def pierced(occ: Any) -> Any:
        holes = [(3, occ.addCylinder(30, -1, 0, 0, 5, 0, 0.1))]
        if halves:
            blocks = [box(occ, (29, -2, -1), (30, 6, 1)), box(occ, (30, -2, -1), (31, 6, 1))]
            pieces = occ.fragment(holes, blocks)[0]
            holes = [piece for piece in pieces if occ.getMass(*piece) < 0.2]
            occ.remove([piece for piece in pieces if piece not in holes])
        return occ.cut(bar(occ), holes)[0]

    path = save(tmp_path / "body.step", pierced)
    with pytest.raises(DesignError, match=r"curve: .* is outside the material from 29.9 to 30.1 mm"):
        CadFile(str(path), 1.5, defeature=0.25)
    assert CadFile(str(path), 1.5, defeature=0.35).solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)


def test_what_cannot_be_removed_stays(tmp_path: Path) -> None:
    """The ring between two round parts of different radius, which do not meet however far they are extended."""

    def stepped(occ: Any) -> Any:
        parts = [(3, occ.addCylinder(0, 0, 0, 30, 0, 0, 7.0)), (3, occ.addCylinder(30, 0, 0, 30, 0, 0, 6.9))]
        dimple = (3, occ.addCylinder(60, 5, 0, -0.3, 0, 0, 0.25))
        return occ.cut(occ.fuse(parts[:1], parts[1:])[0], [box(occ, (3, -2, -4), (57, 3, 4)), dimple])[0]

    path = save(tmp_path / "body.step", stepped)
    given, design = CadFile(str(path), -3.0), CadFile(str(path), -3.0, defeature=0.3)
    assert design.solid_volume == pytest.approx(given.solid_volume + DIMPLE, rel=1e-9)
    assert len(design.edges) == len(given.edges) - 3


def test_inlets_and_several_solids_stay_what_they_are(tmp_path: Path) -> None:
    inlet = save(tmp_path / "inlet.step", lambda occ: occ.fuse(bar_with_inlet(occ), [box(occ, *ON_TOP)])[0])
    design = CadFile(str(inlet), 1.5, plug=True, defeature=0.8)
    assert design.cavity_volume == pytest.approx(BAR_AIR + INLET, rel=1e-9)
    assert design.solid_volume == pytest.approx(BAR_VOLUME - INLET, rel=1e-9)
    two = save(tmp_path / "two.step", lambda occ: [*two_solids(occ), box(occ, *ON_TOP)])
    assert CadFile(str(two), 1.5, unite=True, defeature=0.8).solid_volume == pytest.approx(BAR_VOLUME, rel=1e-9)


def test_other_processes_and_the_hash_of_the_configuration_know_it(tmp_path: Path) -> None:
    save(tmp_path / "body.step", with_details)
    path = tmp_path / "body.yaml"
    path.write_text(
        "name: body\ngeometry: {family: own, file: body.step, curve: 1.5 mm, defeature: 0.8 mm}\n"
        "material: {law: neo_hooke, mu: 0.4 MPa, nu: 0.49}\npressures: [10 kPa]\nmesh: {size: 5 mm}\n",
        encoding="utf-8",
    )
    config = load_config(path)
    assert load_config(path, ["geometry.defeature=0.7 mm"]).hash != config.hash
    sent = pickle.loads(pickle.dumps(config.design))
    (tmp_path / "body.step").unlink()
    assert sent.body(5.0).mesh.volume == pytest.approx(BAR_VOLUME / 2, rel=1e-9)


def test_faces_that_are_splines_are_removed_too(tmp_path: Path) -> None:
    """The poles of splines that Gmsh extends lie beyond the body, which itself does not grow."""

    def splines(occ: Any) -> Any:
        solids = occ.fuse(bar(occ), [box(occ, *ON_TOP)])[0]
        occ.dilate(solids, 0, 0, 0, 0.5, 0.5, 0.5)
        return solids

    path = save(tmp_path / "body.step", splines)
    assert CadFile(str(path), 0.75).extent == pytest.approx((30, 6.05, 7.5), rel=1e-5)
    design = CadFile(str(path), 0.75, defeature=0.3)
    assert design.extent == pytest.approx((30, 6, 7.5), rel=1e-5)
    assert design.solid_volume == pytest.approx(BAR_VOLUME / 8, rel=1e-6)


@pytest.mark.parametrize(
    ("given", "keys", "sentence"),
    [
        ({"defeature": -0.1}, ("defeature",), "must be a positive length, not -0.1"),
        (
            {"defeature": 1.6},
            ("defeature",),
            "1.6 mm is more than half of 2.01 mm, the thinnest wall",
        ),
        ({"defeature": 0.1, "parts": {"base": (1, 1, 1)}}, ("parts", "defeature"), "faces are removed from one"),
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
    with pytest.raises(DesignError, match=r"the volume changes by -1\.\d % .at most 1 %. or the body grows"):
        CadFile(str(path), 1.5, defeature=0.9)
