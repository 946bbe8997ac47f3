"""The body of a design that is meshed and not solved."""

from dataclasses import dataclass
from pathlib import Path

from geometry import Body, Reason
from pipeline.config.config import Config
from pipeline.simulate.mesh_notes import check_body
from pipeline.simulate.scene import mesh_with_progress
from pipeline.simulate.too_short import too_short
from pipeline.store.atomic_file import replacing
from pipeline.store.progress import Progress
from pipeline.store.result_folder import ResultFolder
from pipeline.store.store import open_store
from pipeline.values.formats import BODY


@dataclass(frozen=True)
class MeshedArm:
    """The body of a design that was meshed."""

    file: Path  #: mesh.vtu
    design: Config
    body: Body
    notes: tuple[Reason, ...]


def save_body(folder: ResultFolder, body: Body) -> Path:
    """Write the tetrahedra of a body at rest: the file."""
    file = folder.path(BODY)
    with replacing(file) as part:
        body.mesh.write(part)
    return file


def mesh_alone(design: Config, folder: Path, _: int, __: bool, progress: Progress) -> MeshedArm:
    """Mesh the body and write mesh.vtu. Raises InputError for a folder that cannot be used."""
    with open_store(folder, design, fresh=None) as store:
        progress.stage("mesh")
        body = mesh_with_progress(design, progress).body
        file = save_body(store, body)
    notes = filter(None, (too_short(design), *check_body(body, design)))
    return MeshedArm(file, design, body, tuple(notes))
