"""Imports point one way, lazy ones included, and every heavy library is imported by the listed modules only."""

import subprocess
import sys
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from itertools import starmap

import pytest

from tests.reading import (
    HERE,
    File,
    circles,
    complaints,
    file_imports,
    imported,
    measure,
    read_ceilings,
    read_sources,
    taken,
)

#: room -> the rooms it may import
BELOW: dict[str, set[str]] = {
    "geometry": set(),
    "fem": {"geometry"},
    "rod": {"geometry"},
    "pipeline": {"geometry", "fem", "rod"},
    "pneurod": {"geometry", "fem", "rod", "pipeline"},
}

#: room -> the libraries it may import beside the standard library
LIBRARIES: dict[str, set[str]] = {
    "geometry": {"numpy", "scipy", "gmsh", "meshio", "trimesh"},
    "fem": {"numpy", "scipy", "skfem", "numba", "ipctk", "pypardiso"},
    "rod": {"numpy", "scipy", "numba", "mujoco", "elastica", "matplotlib"},
    "pipeline": {
        *("numpy", "scipy", "numba", "packaging", "yaml", "pydantic", "pydantic_core", "pint"),
        *("pyvista", "typer", "rich", "jinja2", "plotly", "pandas"),
        *("distributed", "psutil", "filelock"),
    },
    "pneurod": set(),
}

#: library -> the only modules, or folders ("fem/kernels/"), that may import it
DOORS: dict[str, set[str]] = {
    "gmsh": {"geometry/meshing/solid.py"},
    "meshio": {"geometry/mesh_content.py"},
    "trimesh": {"geometry/files/surface/triangles.py"},
    "skfem": {"fem/discretisation.py"},
    # the doctor tries the threads of numba
    "numba": {"fem/kernels/", "rod/compiled.py", "pipeline/doctor.py"},
    "ipctk": {"fem/effects/contact.py"},
    "pypardiso": {"fem/equations/pardiso.py"},
    "pydantic": {
        *("pipeline/config/section.py", "pipeline/results/files.py", "pipeline/values/parameters.py"),
        "pipeline/store/kept.py",
    },
    "pydantic_core": {"pipeline/config/section.py", "pipeline/results/laws.py", "pipeline/store/result_folder.py"},
    "pint": {"pipeline/config/units.py"},
    "filelock": {"pipeline/store/store.py"},
    "psutil": {"pipeline/store/worker.py"},
    "yaml": {"pipeline/config/document.py"},
    "pyvista": {"pipeline/show/drawing.py"},
    "typer": {
        *("pipeline/cli/commands.py", "pipeline/cli/ending.py"),
        *(f"pipeline/api/{name}.py" for name in ("measured", "options", "rods", "setup", "studies")),
    },
    "rich": {*("pipeline/cli/commands.py", "pipeline/cli/ending.py", "pipeline/show/progress.py")},
    "jinja2": {"pipeline/values/page.py"},
    "plotly": {"pipeline/values/plots.py"},
    "matplotlib": {"rod/export/programs/pyelastica_arm.py"},
    "mujoco": {"rod/export/programs/mujoco_arm.py", "rod/export/programs/mujoco_space_arm.py"},
    "elastica": {"rod/export/programs/pyelastica_arm.py"},
    "distributed": {"pipeline/study/sweep/workers.py"},
    "pandas": {*("pipeline/api/frames.py", "pipeline/api/results.py"), "pipeline/answers/columns.py"},
}

#: what `pneurod --help` must not wait for
HEAVY = {"numpy", "scipy", "gmsh", "meshio", "trimesh", "skfem", "numba", "ipctk", "pypardiso"} | {
    *("pydantic", "pydantic_core", "pint", "pyvista", "vtkmodules", "jinja2", "plotly", "matplotlib", "pandas"),
    *("distributed", "dask"),
}


def refusals(file: File) -> list[str]:
    """Why the imports of a file are not allowed, one sentence each."""
    module, room = file.path, file.path.partition("/")[0]
    sentences = []
    for name in file.imported:
        library = name.partition(".")[0]
        if library == room or library in sys.stdlib_module_names:
            continue
        if library in BELOW:
            if library not in BELOW[room]:
                sentences.append(f"{module} imports {name}: {room} must not know {library}")
        elif library not in LIBRARIES[room]:
            sentences.append(f"{module} imports {name}: {room} has no use for it")
        elif not DOORS.get(library, {module}) & {module, f"{module.rpartition('/')[0]}/"}:
            sentences.append(f"{module} imports {name}: its door is {', '.join(sorted(DOORS[library]))}")
    return sentences


def test_imports_look_down_through_one_door() -> None:
    files = read_sources()
    assert len(files) > 30
    assert {file.path.partition("/")[0] for file in files} == set(BELOW)
    assert [refusal for file in files for refusal in refusals(file)] == []
    assert sum(len(file.imported) for file in files) > 100


def circle_among(imports: dict[str, set[str]]) -> tuple[str, ...]:
    """Files of `imports` (file -> the files it imports) that import each other in a circle; empty without one."""
    try:
        tuple(TopologicalSorter(imports).static_order())
    except CycleError as error:
        return tuple(error.args[1])
    return ()


def test_no_files_import_each_other_in_a_circle() -> None:
    imports = file_imports(read_sources())
    assert sum(map(len, imports.values())) > 500
    assert circle_among(imports) == ()


def test_the_guard_finds_a_circle_of_lazy_imports() -> None:
    sources = {
        "fem/a.py": "from fem.b import x",
        "fem/b.py": "def f():\n    from fem import c",
        "fem/c.py": "def f():\n    import fem.a",
        "fem/d.py": "from fem import a",
    }
    assert set(circle_among(file_imports(starmap(File, sources.items())))) == {"fem/a.py", "fem/b.py", "fem/c.py"}
    assert circle_among(file_imports(starmap(File, {**sources, "fem/c.py": ""}.items()))) == ()


def unit_of(module: str) -> str:
    """The folder of a file directly below `pipeline`, or the file itself where it stands in none."""
    return module.removeprefix("pipeline/").partition("/")[0]


def unit_imports(imports: dict[str, set[str]]) -> dict[str, set[str]]:
    """Folder, or file beside the folders, of `pipeline` -> the others that it imports; from files -> files."""
    units: dict[str, set[str]] = {}
    for module, others in imports.items():
        if module.startswith("pipeline/"):
            below = {unit_of(other) for other in others if other.startswith("pipeline/")}
            units.setdefault(unit_of(module), set()).update(below - {unit_of(module)})
    return units


def floors_of(imports: dict[str, set[str]]) -> dict[str, int]:
    """The floor of each unit: 1 where it imports no other, else one above the highest that it imports."""
    floors: dict[str, int] = {}
    for unit in TopologicalSorter(imports).static_order():
        floors[unit] = 1 + max((floors[below] for below in imports.get(unit, ())), default=0)
    return floors


def test_folders_of_the_pipeline_stand_on_nine_floors() -> None:
    units = unit_imports(file_imports(read_sources()))
    assert circle_among(units) == ()
    floors = floors_of(
        {unit: below for unit, below in units.items() if unit != "__main__.py"}
    )  # it starts the uppermost
    assert floors["values"] == 1
    assert max(floors.values()) <= 9


def test_the_guard_finds_a_circle_of_folders_whose_files_form_none() -> None:
    imports = {
        "pipeline/a/one.py": {"pipeline/b/one.py"},
        "pipeline/b/one.py": set(),
        "pipeline/b/two.py": {"pipeline/a/one.py", "fem/model.py"},
    }
    assert circle_among(imports) == ()
    assert set(circle_among(unit_imports(imports))) == {"a", "b"}
    assert floors_of({"a": {"b"}, "b": set(), "c.py": {"a", "b"}}) == {"b": 1, "a": 2, "c.py": 3}


def test_a_folder_has_17_files_at_most() -> None:
    counts = Counter(file.path.rpartition("/")[0] for file in read_sources())
    assert {folder: count for folder, count in counts.items() if count > 17} == {}


@pytest.mark.parametrize("library", sorted(DOORS))
def test_every_door_is_used(library: str) -> None:
    """A door that nobody walks through any more must leave the table."""
    for door in DOORS[library]:
        files = sorted((HERE / door).glob("*.py")) if door.endswith("/") else [HERE / door]
        assert files, door
        for file in files:
            names = imported(file.read_text(encoding="utf-8"), str(file.relative_to(HERE)))
            assert library in {name.partition(".")[0] for name in names}, f"{file} does not import {library}"


@pytest.mark.parametrize(
    ("module", "source", "because"),
    [
        ("geometry/mesh.py", "import fem", "geometry must not know fem"),
        ("fem/model.py", "def f():\n    from rod.law import FiveParameters", "fem must not know rod"),
        ("rod/law.py", "import fem.model as model", "rod must not know fem"),
        ("rod/law.py", "if True:\n    from pipeline import config", "rod must not know pipeline"),
        ("geometry/mesh.py", "import numba", "geometry has no use for it"),
        ("fem/model.py", "import gmsh", "fem has no use for it"),
        ("geometry/mesh.py", "def f():\n    import gmsh", "its door is geometry/meshing/solid.py"),
        ("fem/model.py", "from skfem.helpers import grad", "its door is fem/discretisation.py"),
        ("fem/model.py", "from numba import njit", "its door is fem/kernels/"),
        ("fem/model.py", "import importlib\nimportlib.import_module('rod')", "fem has no use for it"),
        ("pipeline/store/store.py", "import pyvista", "its door is pipeline/show/drawing.py"),
        ("pipeline/store/store.py", "import requests", "pipeline has no use for it"),
        ("pipeline/show/saved.py", "import pandas", "pipeline/answers/columns.py"),
        ("pipeline/cli/commands.py", "def f():\n    from pneurod import Results", "pipeline must not know pneurod"),
        ("fem/model.py", "import pneurod", "fem must not know pneurod"),
    ],
)
def test_the_guard_bites(module: str, source: str, because: str) -> None:
    assert [refusal for refusal in refusals(File(module, source)) if because in refusal], because


def loaded_after(statement: str) -> set[str]:
    """The top-level modules loaded by `statement` in a fresh process."""
    command = f"import sys\n{statement}\nprint(*{{name.partition('.')[0] for name in sys.modules}})"
    done = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=True, cwd=HERE)
    return set(done.stdout.split())


def loaded_by_command(*arguments: str, says: str) -> set[str]:
    """The top-level modules that a command of the command line loads; `says` is part of what it prints."""
    return loaded_after(
        "import contextlib, io\n"
        "from pipeline.cli import app\n"
        "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()) as printed:\n"
        f"    app({list(arguments)!r})\n"
        f"assert {says!r} in printed.getvalue(), printed.getvalue()\n"
    )


def test_help_waits_for_nothing_heavy() -> None:
    loaded = loaded_by_command("--help", says="Commands")
    assert "typer" in loaded
    assert loaded & HEAVY == set()


def test_a_configuration_is_read_without_the_machines() -> None:
    loaded = loaded_after("from pipeline.config.load import load_config\nload_config('configs/pneunet.yaml')")
    assert {"pydantic", "geometry"} <= loaded
    assert loaded & {"pint", "gmsh", "meshio", "skfem", "numba", "ipctk", "pypardiso", "pyvista", "plotly"} == set()


def test_the_rod_of_a_run_is_solved_without_the_machines() -> None:
    loaded = loaded_after(
        "from pathlib import Path\n"
        "from pipeline.answers.rods.choice import rod_of_path\n"
        "from pipeline.answers.rods.end_loads import read_loading, shape_under\n"
        "rod = rod_of_path(Path('tests/data/results_coarse'), None).at(31.0)\n"
        "shape_under(rod, read_loading(None, None, force='[0 N, 0.01 N]'))"
    )
    assert {"numpy", "pydantic"} <= loaded
    assert loaded & (HEAVY - {"numpy", "pydantic", "pydantic_core"}) == set()


def test_a_file_asks_no_more_of_its_reader() -> None:
    files = read_sources()
    assert sum(file.names for file in files) > 3000
    assert complaints(read_ceilings(), measure(files)) == []


#: file -> its text, of a house of three folders that form a circle
HOUSE = {
    "rod/a/one.py": "from rod.b.two import X, BarLaw\nfrom rod.law import Law\n",
    "rod/b/two.py": (
        '"""Two."""\n\nfrom rod.c import three\n\nX = 1\n\n\nclass BarLaw:\n    """A law."""\n\n    a: int\n\n\n'
        "def f(value, *, b):\n    from rod.c.three import g\n\n    if isinstance(value, BarLaw | int):\n"
        "        return g(b)\n    raise ValueError('that is no law')\n"
    ),
    "rod/c/three.py": "def g(b):\n    # nothing else\n    import rod.a.one\n    return isinstance(b, int)\n",
    "fem/law.py": "def f(law):\n    return isinstance(law, RubberLaw)\n",
    "rod/law.py": "class Law:\n    pass\n",
}


def test_the_figures_of_a_small_house() -> None:
    files = {path: File(path, source) for path, source in HOUSE.items()}
    two = files["rod/b/two.py"]
    assert (two.names, two.modules, two.inside, two.kinds) == (2, 2, 1, 1)
    assert (two.code, two.code - two.frame) == ({3, 5, 8, 11, 14, 15, 17, 18, 19}, {17, 18})
    assert circles(file_imports(files.values())) == [["rod/a", "rod/b", "rod/c"]]
    assert taken(files.values()) == {"rod/b": 2, "rod/c": 2}
    figures = measure(list(files.values()))
    assert figures["rod: names that a file imports, nine tenths"] == 3
    assert figures["isinstance on kinds of law, rod and shape"] == 1
    assert figures["imports inside functions"] == 2
    assert figures["most parameters outside pipeline/api"] == 2
    assert figures["lines of the longest function"] == 6


def test_the_guard_refuses_what_rises_and_ceilings_that_are_too_high() -> None:
    assert complaints({"names": 20, "circles": 4}, {"names": 20, "circles": 4}) == []
    assert complaints({"names": 20}, {"names": 19}) == []
    assert complaints({"names": 20}, {"names": 21}) == ["names: 21, and 20 are allowed"]
    (high,) = complaints({"circles": 4}, {"circles": 3})
    assert high.startswith("circles: 3, and 4 are allowed; `python -m tests.reading --lower`")
    assert complaints({}, {"circles": 3}) == ["circles: has no ceiling or no figure"]
