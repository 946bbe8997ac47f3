"""Impossible dimensions raise `DesignError` with the names of their config keys."""

from dataclasses import fields

import pytest

from geometry import (
    FAMILIES,
    BisectedCircle,
    Design,
    DesignError,
    PneuNet,
    Rectangular,
    Semicircular,
    SemicircularSingle,
)


def names(design: type[Design]) -> list[str]:
    return [field.name for field in fields(design)]  # type: ignore[arg-type]


#: one length for each chamber or gap
LISTS = ["chamber_lengths", "chamber_heights", "gaps"]
LENGTHS = [(design, key) for design in FAMILIES.values() for key in names(design) if key not in ("chambers", *LISTS)]
#: that are zero unless they are given
OR_ZERO = [(PneuNet, "fillet")]


@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf"), "2 mm", True, None, (1.0, 2.0)])
@pytest.mark.parametrize(("family", "key"), [length for length in LENGTHS if length not in OR_ZERO])
def test_every_length_must_be_a_positive_number(family: type[Design], key: str, value: object) -> None:
    with pytest.raises(DesignError, match=f"^{key}: must be a positive length") as caught:
        family(**{key: value})
    assert caught.value.keys == (key,)


@pytest.mark.parametrize("value", [-2.0, "2 mm", None, [1.0, 2.0]])
@pytest.mark.parametrize("key", LISTS)
def test_what_differs_between_chambers_is_a_tuple(key: str, value: object) -> None:
    with pytest.raises(DesignError, match=f"^{key}: must be a tuple of positive lengths, not"):
        PneuNet(**{key: value})
    with pytest.raises(DesignError, match=f"^{key}: entry 2 must be a positive length"):
        PneuNet(**{key: (1.0, value)})


@pytest.mark.parametrize("value", [-1.0, float("nan"), "2 mm", True, False, None])
@pytest.mark.parametrize(("family", "key"), OR_ZERO)
def test_a_length_that_may_be_zero_is_no_other_number(family: type[Design], key: str, value: object) -> None:
    with pytest.raises(DesignError, match=f"^{key}: must be a positive length or 0, not"):
        family(**{key: value})
    assert family(**{key: 0}) == family()


@pytest.mark.parametrize("family", FAMILIES.values())
def test_walls_in_another_unit_are_refused_by_their_ratio(family: type[Design]) -> None:
    key = next(name for name in ("wall", "dividing_wall", "base") if name in names(family))
    with pytest.raises(DesignError, match=f"^{key}: 0.0012 mm is less than 0.0005 of the smallest side") as caught:
        family(**{key: 1.2e-3})
    assert caught.value.keys == (key,)
    assert isinstance(family(**{key: 0.01}), Design)


@pytest.mark.parametrize("chambers", [0, -3, 2.0, True, "eleven", (3,)])
@pytest.mark.parametrize("family", [PneuNet, Semicircular, Rectangular])
def test_chambers_must_be_counted(family: type[Design], chambers: object) -> None:
    with pytest.raises(DesignError, match="chambers: must be a whole number of at least 1"):
        family(chambers=chambers)


@pytest.mark.parametrize(
    ("family", "dimensions", "keys"),
    [
        (
            PneuNet,
            {"wall": 5, "side_wall": 8, "roof": 13, "channel": 3, "fillet": 20},
            ["wall", "side_wall", "roof", "channel", "fillet", "fillet"],
        ),
        (
            PneuNet,
            {"wall": -1, "width": float("nan"), "chambers": 0, "roof": 13},
            ["chambers", "width", "wall", "roof"],
        ),
        (PneuNet, {"wall": "5 mm", "width": 0, "roof": 13}, ["width", "wall"]),
        (PneuNet, {"gaps": (2, -1, 0), "chambers": 2, "roof": 13}, ["gaps", "gaps", "roof"]),
        (Semicircular, {"wall": 7.5, "channel": 8}, ["wall"]),
        (SemicircularSingle, {"wall": 8, "end_wall": 60}, ["wall", "end_wall"]),
        (BisectedCircle, {"wall": 8, "end_wall": 60, "divider": 20}, ["wall", "end_wall"]),
        (BisectedCircle, {"end_wall": 60, "divider": 20}, ["end_wall", "divider"]),
        (Rectangular, {"side_wall": 7.5, "roof": 14, "channel": 30}, ["side_wall", "base"]),
        (Rectangular, {"side_wall": -2, "roof": 14}, ["side_wall", "base"]),
    ],
)
def test_all_that_is_wrong_is_told_together(family: type[Design], dimensions: dict, keys: list[str]) -> None:
    """But not what follows from another mistake: walls that leave no cavity leave no room for a channel either."""
    with pytest.raises(DesignError) as caught:
        family(**dimensions)
    errors = (caught.value, *caught.value.others)
    assert [error.keys[0] for error in errors] == keys
    assert all(error.sentence in str(caught.value) for error in errors)


def test_regions_that_a_body_does_not_have_are_told_together() -> None:
    with pytest.raises(DesignError, match=r"^materials\.lid: .*; materials\.foot: this body has no region") as caught:
        PneuNet().with_regions(["lid", "base", "foot"])
    assert [error.keys for error in caught.value.others] == [("materials.foot",)]
