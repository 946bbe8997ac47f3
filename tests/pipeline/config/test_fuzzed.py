"""Every configuration is meshed or refused in one sentence: no traceback, no endless run.

`make fuzz` runs the large number of examples and says how many of them ended how.
"""

import faulthandler
import json
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, event, given, settings

from geometry.families.design import expected_tets
from pipeline.config.load import load_config
from pipeline.simulate.scene import Scene
from pipeline.values.errors import InputError
from tests.bodies import DATA
from tests.fuzzed import Written, configurations

CONFIGS = Path(__file__).resolve().parent.parent.parent.parent / "configs"

SMALL, AFFORDABLE = 1_200, 60_000
"""Elements of the largest body that is meshed in the short test and in the long one."""
LONGEST_SENTENCE = 600
HANG = 300.0
"""Seconds after which an example that does not come back ends the tests, with the place where it is."""


def examples(number: int) -> settings:
    """So many examples, the same every time; a counterexample is made small and shown."""
    return settings(
        max_examples=number,
        derandomize=True,
        database=None,
        deadline=None,  # a body may take a second
        suppress_health_check=list(HealthCheck),  # the documents are large
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Sound and spoilt files that a configuration may name, and room for the configuration itself."""
    directory = tmp_path_factory.mktemp("fuzzed")
    drawing, mesh = (CONFIGS / "finger.step").read_bytes(), (DATA / "t2_coarse.msh").read_bytes()
    for name, content in {
        "finger.step": drawing,
        "ready.msh": mesh,
        "cut.step": drawing[: len(drawing) // 2],
        "cut.msh": mesh[: len(mesh) // 2],
        **dict.fromkeys(("empty.step", "empty.msh"), b""),
        **dict.fromkeys(("text.brep", "text.msh"), b"hello\n"),
    }.items():
        (directory / name).write_bytes(content)
    for name in ("folder.step", "folder.msh"):
        (directory / name).mkdir()
    return directory


def check_sentences(sentences: tuple[str, ...]) -> None:
    assert sentences
    for sentence in sentences:
        assert sentence.isprintable()
        assert len(sentence) < LONGEST_SENTENCE


def first_stage(folder: Path, written: Written, largest: int) -> str:
    """How it ended; bodies of more than `largest` elements are not meshed here."""
    path = folder / "arm.yaml"
    path.write_bytes(written.content)
    try:
        config = load_config(path, written.settings)
        json.dumps(config.record(), allow_nan=False)
        size = config.mesh.size_mm
        extent, volume = config.design.extent, config.design.solid_volume / 2
        if expected_tets(size, extent, volume) > largest:
            return "accepted, too large to be meshed here"
        body = Scene.meshed(config).body
    except InputError as refused:
        check_sentences(refused.sentences)
        return "refused"
    assert body.mesh.volume > 0
    return "meshed"


@pytest.mark.parametrize("number", [100, pytest.param(200, marks=pytest.mark.slow)])
def test_every_configuration_is_read_or_refused_in_one_sentence(folder: Path, number: int) -> None:
    seen: Counter[str] = Counter()

    @examples(number)
    @given(written=configurations())
    def tried(written: Written) -> None:
        seen[first_stage(folder, written, SMALL)] += 1

    tried()
    # hypothesis also draws constants that it finds in the loaded modules, so that the number of each depends on them
    assert min(seen["refused"], number - seen["refused"]) >= number // 20
    assert seen["meshed"]


@pytest.mark.slow
@examples(2000)
@given(written=configurations())
def test_two_thousand_configurations_are_meshed_or_refused(folder: Path, written: Written) -> None:
    faulthandler.dump_traceback_later(HANG, exit=True)
    try:
        event(first_stage(folder, written, AFFORDABLE))
    finally:
        faulthandler.cancel_dump_traceback_later()
