"""Result files are written atomically, states are reused for their own configuration only, a folder has one owner."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pipeline.config.config import Config
from pipeline.config.load import load_config
from pipeline.store import atomic_file, state_key
from pipeline.store.owner import MOTION, OWNERS, RUN, Owner, claim
from pipeline.store.provenance import provenance, required
from pipeline.store.result_folder import MADE, ResultFolder
from pipeline.store.state_key import ALL_SOURCES, NUMBER_SOURCES, STATE_SOURCES, result_key, source_files
from pipeline.store.store import Store, open_store
from pipeline.values.errors import InputError, on_command_line

ROOMS = ("geometry", "fem", "rod", "pipeline")


@pytest.fixture
def config(configs: Path) -> Config:
    return load_config(configs / "pneunet_coarse.yaml")


@pytest.fixture
def other(configs: Path) -> Config:
    return load_config(configs / "pneunet_coarse.yaml", ["mesh.size=3 mm"])


def files(directory: Path) -> set[str]:
    """All files but the lock of the run that is at work."""
    found = {str(path.relative_to(directory)) for path in directory.rglob("*") if path.is_file()}
    return found - {".pneurod-lock", MADE}


def test_json_and_rows_come_back(tmp_path: Path, config: Config) -> None:
    with open_store(tmp_path / "out", config) as store:
        store.save_json("a.json", {"x": np.float64(0.1), "n": np.int64(3), "row": np.array([1.0, np.nan]), "t": (1, 2)})
        store.save_rows(
            "b.csv", ["experiment", "s_mm"], [["I", 0.1 + 0.2], ["II", float("nan")], ["III", np.float64(3)]]
        )
        assert store.read_json("a.json") == {"x": 0.1, "n": 3, "row": [1.0, None], "t": [1, 2]}
        assert store.read_json("none.json") is None
        assert '"row": [1.0, null]' in (tmp_path / "out/a.json").read_text()
        texts = {"a": ["[\n 1\n]", "b"], "rows": [[1, 2], []], "none": [], "objects": [{"x": [True]}]}
        store.save_json("c.json", texts)
        assert store.read_json("c.json") == texts
    assert (tmp_path / "out" / "b.csv").read_text() == "experiment,s_mm\nI,0.30000000000000004\nII,\nIII,3.0\n"


def test_a_write_that_fails_leaves_the_old_file(
    tmp_path: Path, config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    with open_store(tmp_path, config) as store:
        store.save_json("a.json", 1)
        before = files(tmp_path)
        monkeypatch.setattr(atomic_file.os, "fsync", full)
        with pytest.raises(OSError, match="No space left"):
            store.save_json("a.json", 2)
        with pytest.raises(OSError, match="No space left"):
            store.save_state("II", 17.0, u=np.zeros(3))
        assert store.read_json("a.json") == 1
        assert files(tmp_path) == before


def test_a_process_killed_while_writing_leaves_whole_files(tmp_path: Path, configs: Path, config: Config) -> None:
    script = (
        "import sys, numpy as np\n"
        "from pipeline.config.load import load_config\n"
        "from pipeline.store.store import open_store\n"
        f"with open_store({str(tmp_path)!r}, load_config({str(configs / 'pneunet_coarse.yaml')!r})) as store:\n"
        "    for number in range(10**6):\n"
        "        store.save_state('II', 17.0, u=np.full(10**5, float(number)))\n"
        "        print(number, flush=True)\n"
    )
    writer = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, cwd=configs.parent)
    for _ in range(5):
        writer.stdout.readline()
    writer.send_signal(signal.SIGKILL)
    writer.wait()
    writer.stdout.close()
    with open_store(tmp_path, config) as store:
        state = store.load_state("II", 17.0)
        assert np.ptp(state["u"]) == 0.0
    assert not [name for name in files(tmp_path) if "part" in name]


def test_temporary_files_of_workers_that_were_ended_are_removed(tmp_path: Path, config: Config) -> None:
    with pytest.raises(KeyboardInterrupt):
        _interrupted_beside_another_process(tmp_path, config)
    assert not [name for name in files(tmp_path) if "part" in name]
    assert "states/II_17kPa.npz" in files(tmp_path)


def _interrupted_beside_another_process(folder: Path, config: Config) -> None:
    with open_store(folder, config) as store:
        with atomic_file.replacing(store.path("states/II_17kPa.npz")) as part:
            part.with_name(part.name.replace(".npz", "x.npz")).touch()  # that of the other process
        assert len([name for name in files(folder) if "part" in name]) == 1
        raise KeyboardInterrupt


def test_states_are_remembered(tmp_path: Path, config: Config) -> None:
    u = np.random.default_rng(1).normal(size=(50, 3))
    with open_store(tmp_path, config) as store:
        assert store.load_state("II", 17.0) is None
        store.save_state("II", 17.0, u=u, reaction=0.08, note="converged")
    with open_store(tmp_path, config) as store:
        state = store.load_state("II", 17.0)
        assert set(state) == {"u", "reaction", "note"}
        np.testing.assert_array_equal(state["u"], u)
        assert float(state["reaction"]) == 0.08
        assert str(state["note"]) == "converged"
        assert store.load_state("III", 17.0) is None
        assert store.load_state("II", 17.5) is None


def test_states_of_another_key_or_broken_ones_are_not_used(tmp_path: Path, config: Config) -> None:
    with open_store(tmp_path, config) as store:
        store.save_state("II", 17.0, u=np.zeros(3))
        assert Store(tmp_path, "0" * 64, "0" * 64).load_state("II", 17.0) is None
        state = tmp_path / "states" / "II_17kPa.npz"
        state.write_bytes(state.read_bytes()[:100])
        assert store.load_state("II", 17.0) is None


def test_the_keys_take_every_source_file() -> None:
    """A file that the key forgets would let states of other sources be used again."""
    root = Path(state_key.__file__).resolve().parents[1]
    while not (root / "pyproject.toml").is_file():
        root = root.parent
    deciding = {str(path.relative_to(root)) for path in source_files(STATE_SOURCES)}
    numbers = {str(path.relative_to(root)) for path in source_files(NUMBER_SOURCES)}
    every = {str(path.relative_to(root)) for path in source_files(ALL_SOURCES)}
    rooms = {room: {str(path.relative_to(root)) for path in (root / room).rglob("*.py")} for room in ROOMS}
    assert all(len(sources) > 10 for sources in rooms.values())
    assert deciding >= rooms["geometry"] | rooms["fem"]
    assert numbers > deciding | rooms["rod"]
    used = re.compile(r"^from pipeline\.simulate\.(\w+) import", re.MULTILINE)
    solving = [name for name in deciding if name.startswith("pipeline/simulate/")]
    modules = {
        f"pipeline/simulate/{module}.py" for name in solving for module in used.findall((root / name).read_text())
    }
    of_results = {f"pipeline/simulate/{name}.py" for name in ("mass", "outcome", "records")}
    assert len(modules) > 4
    assert modules - deciding == of_results
    assert every == set().union(*rooms.values())


@pytest.mark.parametrize("name", STATE_SOURCES)
def test_a_key_changes_with_the_sources_of_every_room(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of one room alone are changed, so a room that the key forgets is seen."""
    changed = set(source_files([name]))
    assert changed
    key = result_key("hash", STATE_SOURCES)
    assert key == result_key("hash", STATE_SOURCES)
    assert key != result_key("another", STATE_SOURCES)
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + (b"# changed" if path in changed else b""))
    assert key != result_key("hash", STATE_SOURCES)


def test_results_of_another_configuration_are_refused(tmp_path: Path, config: Config, other: Config) -> None:
    with open_store(tmp_path, config) as store:
        store.save_json("parameters.json", {})
        store.save_state("II", 17.0, u=np.zeros(3))
    with (
        pytest.raises(InputError, match="a run with another configuration; give another out, or fresh=True"),
        open_store(tmp_path, other),
    ):
        pass
    assert "parameters.json" in files(tmp_path)
    with open_store(tmp_path, other, fresh=True):
        assert files(tmp_path) == {"states/configuration.json"}


def test_fresh_spares_what_no_run_wrote(tmp_path: Path, config: Config) -> None:
    (tmp_path / "mine.json").write_text("{}")
    by_hand = tmp_path / "report.html"
    by_hand.write_text("mine too: no run has been here")
    for fresh in (False, True, None):
        with (
            pytest.raises(
                InputError, match=r"report\.html in it was not made by this command, or changed since; rename"
            ),
            open_store(tmp_path, config, fresh=fresh),
        ):
            pass
    by_hand.unlink()
    with open_store(tmp_path, config, fresh=True) as store:
        store.save_state("II", 17.0, u=np.zeros(3))
        assert files(tmp_path) == {"mine.json", "states/configuration.json", "states/II_17kPa.npz"}
    with open_store(tmp_path, config, fresh=True) as store:
        assert store.load_state("II", 17.0) is None
        assert files(tmp_path) == {"mine.json", "states/configuration.json"}


def test_two_runs_do_not_share_a_folder(tmp_path: Path, config: Config) -> None:
    with (
        open_store(tmp_path, config),
        pytest.raises(InputError, match="another run is at work in it"),
        open_store(tmp_path, config),
    ):
        pass
    with open_store(tmp_path, config):
        pass
    assert not (tmp_path / ".pneurod-lock").exists()


def test_a_folder_whose_run_was_killed_is_free(tmp_path: Path, configs: Path, config: Config) -> None:
    script = (
        "import os, signal\n"
        "from pipeline.config.load import load_config\n"
        "from pipeline.store.store import open_store\n"
        f"with open_store({str(tmp_path)!r}, load_config({str(configs / 'pneunet_coarse.yaml')!r})):\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    killed = subprocess.run([sys.executable, "-c", script], cwd=configs.parent, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert (tmp_path / ".pneurod-lock").exists()
    with open_store(tmp_path, config):
        pass


def test_a_folder_that_cannot_be_written_is_refused(tmp_path: Path, config: Config) -> None:
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file" / "out", Path("/proc/pneurod")):
        with (
            on_command_line(),
            pytest.raises(InputError, match=r"^--out .* cannot be written \(.+\); give a folder you may write to$"),
            open_store(out, config),
        ):
            pass


def test_provenance_names_what_the_results_were_made_with() -> None:
    record = provenance()
    assert json.loads(json.dumps(record)) == record
    if (Path(__file__).resolve().parent.parent.parent.parent / ".git").exists():
        assert re.fullmatch(r"[0-9a-f]{40}\+?", record["commit"])
    assert record["packages"]["numpy"] == np.__version__
    assert {"gmsh", "ipctk", "scikit-fem"} <= set(required())
    assert not {"gmsh", "ipctk", "scikit-fem"} & set(required(""))
    assert "pytest" not in required()
    assert record["machine"]["cores"] == os.cpu_count()


@pytest.mark.parametrize("owner", OWNERS, ids=lambda owner: owner.mark)
def test_each_command_is_repeated_and_refuses_what_another_or_a_hand_has_made(owner: Owner, tmp_path: Path) -> None:
    def made(mark: str) -> Path:
        folder = tmp_path / mark.replace("/", "_")
        ResultFolder(folder).save_text(mark, "{}")
        return folder

    for other in OWNERS:
        for fresh in (None, False, True) if other is not owner else ():
            with pytest.raises(InputError, match=f"holds the results of {other.name}; give another out$"):
                claim(made(other.mark), owner, fresh=fresh)
            assert (tmp_path / other.mark.replace("/", "_") / other.mark).read_text() == "{}"
    own = claim(made(owner.mark), owner)
    for name in owner.files:
        own.save_text(name, "made by an earlier call")
    assert claim(own.directory, owner) == own
    with pytest.raises(InputError, match=f"of {owner.name} with another setting; give another out, or fresh=True"):
        claim(own.directory, owner, {"setting": 1}, fresh=False)
    claim(own.directory, owner, {"setting": 1}, fresh=True)
    assert files(own.directory) == set()
    for name in owner.files:
        by_hand = ResultFolder(tmp_path / "by_hand")
        by_hand.save_text(name, "mine")
        by_hand.path(MADE).unlink()
        with pytest.raises(InputError, match=f"{name} in it was not made by this command"):
            claim(by_hand.directory, owner, fresh=True)
        by_hand.path(name).unlink()
        own.save_text(owner.mark, "{}")
        own.save_text(name, "made")
        own.path(name).write_text("made, and a note by hand")
        for fresh in (None, True):
            with pytest.raises(InputError, match=f"{name} in it was not made by this command, or changed since"):
                claim(own.directory, owner, fresh=fresh)
        assert own.path(name).read_text() == "made, and a note by hand"
        own.save_text(name, "made")


def test_a_folder_in_which_nothing_was_solved_is_for_any_configuration(
    tmp_path: Path, config: Config, other: Config
) -> None:
    for one in (config, other):
        with open_store(tmp_path, one) as store:
            store.save_text("mesh.vtu", "body")


def test_a_motion_stands_beside_its_law_and_spares_a_table_by_hand(tmp_path: Path) -> None:
    folder = ResultFolder(tmp_path)
    folder.save_json(RUN.mark, {})
    folder.path("motion.csv").write_text("by hand")
    with pytest.raises(InputError, match=r"motion\.csv in it was not made by this command"):
        claim(tmp_path, MOTION)
    folder.save_text("motion.html", "of an earlier call")
    assert claim(tmp_path, MOTION) == folder
