"""What accuracy costs: the ladder of meshes, elements and tolerances, each rung with its seconds and its error."""

from pathlib import Path
from typing import Any

from pipeline.accuracy.figure import html_page, svg_picture
from pipeline.accuracy.ladder import Rung, ladder
from pipeline.accuracy.measure import measured_apart
from pipeline.accuracy.record import accuracy_record
from pipeline.config.config import Config
from pipeline.progress import Progress
from pipeline.simulation.scene import Scene
from pipeline.store.store import open_store


def climb(config: Config, out: Path, jobs: int, fresh: bool, progress: Progress) -> dict[str, Any]:
    """Measure every rung that `out` does not hold yet; the content of `out`/accuracy.json.

    Raises InputError for a body that cannot be meshed or a folder that cannot be used, and RunFailed where too few
    rungs were reached to hold the others against.
    """
    with open_store(out, config, fresh=fresh) as store:
        touching = Scene.meshed(config).activation_distance
        rungs = ladder(config, touching)
        files = {rung.folder: f"rungs/{rung.folder}.json" for rung in rungs}
        found = {name: store.read_json(file) for name, file in files.items()}
        missing = [rung for rung in rungs if (found[rung.folder] or {}).get("key") != store.numbers_key]
        progress.stage(f"ladder: {len(rungs)} rungs, {len(missing)} of them to be measured")

        def keep(rung: Rung, measured: dict[str, Any]) -> None:
            found[rung.folder] = {"key": store.numbers_key, **measured}
            store.save_json(files[rung.folder], found[rung.folder])
            said = f"{measured['cpu_seconds']:.0f} s of CPU" if "cpu_seconds" in measured else measured["failure"]
            progress.stage(f"{rung.choice} {rung.value:g}: {said}")

        measured_apart(missing, jobs, keep)
        record = accuracy_record(config, [(rung, found[rung.folder]) for rung in rungs], touching)
        store.save_json("accuracy.json", record)
        store.save_text("accuracy.html", html_page(record))
        store.save_text("accuracy.svg", svg_picture(record))
    return record
