"""The wheel contains every source file and every file that the sources read."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent.parent
ROOMS = ("geometry", "fem", "rod", "pipeline", "pneurod")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built of the sources as they are."""
    folder = tmp_path_factory.mktemp("wheel")
    sources = folder / "sources"
    for room in ROOMS:
        for path in (HERE / room).rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                copy = sources / path.relative_to(HERE)
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes(path.read_bytes())
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        (sources / name).write_bytes((HERE / name).read_bytes())
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir"]
    subprocess.run([*command, str(folder), str(sources)], check=True, capture_output=True, text=True)
    [built] = folder.glob("*.whl")
    return built


def test_the_wheel_holds_every_source_file(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        inside = {name for name in archive.namelist() if name.partition("/")[0] in ROOMS}
    sources = {
        str(path.relative_to(HERE))
        for room in ROOMS
        for path in (HERE / room).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert len(sources) > 130
    assert inside == sources
