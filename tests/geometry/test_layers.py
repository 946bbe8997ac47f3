"""The folders of geometry import downwards only: meshes, then meshing, families, and bodies from files."""

from tests.reading import HERE, imported

LAYERS = ("", "meshing", "families", "files")


def layer(module: str) -> int:
    """Number of the folder of a module of geometry ("geometry/meshing/solid.py"), 0 for the room itself."""
    folder = module.split("/")[1] if module.count("/") > 1 else ""
    return LAYERS.index(folder)


def test_folders_import_downwards() -> None:
    paths = sorted(str(path.relative_to(HERE)) for path in (HERE / "geometry").rglob("*.py"))
    paths = [path for path in paths if path not in ("geometry/__init__.py", "geometry/public.py")]
    assert len(paths) > 25
    upwards = [
        (module, name)
        for module in paths
        for name in imported((HERE / module).read_text(encoding="utf-8"), module)
        if name.startswith("geometry.")
        if layer(name.replace(".", "/") + ("/x.py" if name.split(".")[-1] in LAYERS else ".py")) > layer(module)
    ]
    assert upwards == []
