"""The elements in an Abaqus input file: those of its one part or instance, or of a file without parts.

meshio takes the last *NODE block of a file for all of its points, so that a reference point of the assembly, or a
second part, replaces those of the body; it knows no C3D4H and no types in small letters. Gmsh takes such a file for a
program of its own language.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from geometry.arrays import Array, Index
from geometry.errors import MeshError
from geometry.files.companions import included

#: type of an element of a volume, with its number of nodes: C3D4, C3D10MH
_VOLUME = re.compile(r"C3D(\d+)")
#: what a user calls them, by their number of nodes
_OTHERS = {5: "pyramids", 6: "prisms", 8: "hexahedra", 15: "prisms", 20: "hexahedra", 27: "hexahedra"}


@dataclass
class _Scope:
    """Nodes and elements that are numbered together: those of a part or an instance, or all outside of these."""

    name: str
    rows: dict[int, int] = field(default_factory=dict)  #: number of a node -> its row in `points`
    points: list[list[float]] = field(default_factory=list)
    elements: dict[int, list[int]] = field(default_factory=dict)  #: nodes of an element -> number and nodes of all such
    instances: list[str] = field(default_factory=list)  #: names of the instances of a part


def read_abaqus(path: Path) -> tuple[Array, list[Index], Mapping[str, int]]:
    """Points (n, 3), tetrahedra with 4 and 10 nodes, (m, 4) and (m, 10), and how many other elements of a volume there
    are, by what a user calls them. Points of a part are where the part has them, not where its instance is moved to.

    Raises `MeshError` for a file that cannot be read, or whose elements belong to several parts or instances.
    """
    body = _only(path, _scopes(path))
    others: dict[str, int] = {}
    blocks = []
    for count, numbers in body.elements.items():
        if len(numbers) % (count + 1):
            raise MeshError(f"the mesh file {path} has an element of the type C3D{count} without all of its nodes")
        if count not in (4, 10):
            name = _OTHERS.get(count, f"elements of the type C3D{count}")
            others[name] = others.get(name, 0) + len(numbers) // (count + 1)
            continue
        try:
            blocks.append(np.array([body.rows[number] for number in _nodes(numbers, count)]).reshape(-1, count))
        except KeyError as missing:
            raise MeshError(
                f"an element in the mesh file {path} has the node {missing}, which is not defined where the element is"
            ) from None
    return np.array(body.points, dtype=np.float64).reshape(-1, 3), blocks, others


def _nodes(numbers: list[int], count: int) -> list[int]:
    """The nodes of elements, without the number of each element before them."""
    return [number for k, number in enumerate(numbers) if k % (count + 1)]


def _only(path: Path, scopes: list[_Scope]) -> _Scope:
    """The one with elements, or the first where none has any. Raises `MeshError` where several have."""
    bodies = [scope for scope in scopes if scope.elements] or scopes[:1]
    names = ", ".join(scope.name for scope in bodies)
    remedy = "save the arm alone, or merge them to one part in the program that wrote it"
    if len(bodies) > 1:
        raise MeshError(f"the mesh file {path} holds {len(bodies)} parts with elements ({names}); {remedy}")
    if len(bodies[0].instances) > 1:
        instances = ", ".join(bodies[0].instances)
        many = len(bodies[0].instances)
        raise MeshError(f"the mesh file {path} holds {many} instances ({instances}) of the part {names}; {remedy}")
    return bodies[0]


def _scopes(path: Path) -> list[_Scope]:
    """What belongs to no part, and the parts and instances of a file."""
    scopes = [_Scope("outside of parts")]
    scope = scopes[0]
    for keyword, options, data in _blocks(path):
        if keyword in ("NODE", "ELEMENT") and "INPUT" in options:
            raise MeshError(
                f"the mesh file {path} has its *{keyword} lines in another file ({options['INPUT']}); write them into "
                "it, or include that file with *INCLUDE"
            )
        if keyword in ("PART", "INSTANCE"):
            name, part = options.get("NAME", ""), options.get("PART", "")
            for known in scopes:
                if keyword == "INSTANCE" and known.name.lower() == part.lower():
                    known.instances.append(name)
            scope = _Scope(name)
            scopes.append(scope)
        elif keyword in ("END PART", "END INSTANCE"):
            scope = scopes[0]
        elif keyword == "SYSTEM" or (keyword == "NODE" and options.get("SYSTEM", "R").upper() != "R"):
            raise MeshError(
                f"the mesh file {path} has nodes in a coordinate system of their own (*{keyword}); save it with "
                "Cartesian coordinates"
            )
        elif keyword == "NODE":
            _add_nodes(path, scope, data)
        elif keyword == "ELEMENT" and (volume := _VOLUME.match(options.get("TYPE", "").upper())):
            numbers = (entry for line in data for entry in line.split(","))
            scope.elements.setdefault(int(volume[1]), []).extend(_numbers(path, numbers))
    return scopes


def _add_nodes(path: Path, scope: _Scope, data: list[str]) -> None:
    for line in data:
        number, *coordinates = line.split(",")
        try:
            node = int(number)
            x, y, z = map(float, coordinates[:3])
        except ValueError:
            raise MeshError(f"the mesh file {path} cannot be read: '{line.strip()}' is no node") from None
        scope.rows[node] = len(scope.points)
        scope.points.append([x, y, z])


def _numbers(path: Path, entries: Iterable[str]) -> list[int]:
    """Entries of lines as integers; a line may end with an empty one, because it goes on in the next line."""
    try:
        return [int(entry) for entry in entries if entry.strip()]
    except ValueError as error:
        raise MeshError(f"the mesh file {path} cannot be read: {error}") from None


def _blocks(path: Path) -> Iterator[tuple[str, dict[str, str], list[str]]]:
    """Keyword, options and lines of data, both names in capitals; what stands before the first keyword is left out."""
    head, data = "", []
    for line in _lines(path, ()):
        if head.endswith(","):  # the options go on
            head += line.strip()
        elif not line.lstrip().startswith("*"):
            data.append(line)
        else:
            yield *_options(head), data
            head, data = line.strip(), []
    yield *_options(head), data


def _options(head: str) -> tuple[str, dict[str, str]]:
    keyword, *entries = head.removeprefix("*").split(",")
    pairs = (entry.partition("=")[::2] for entry in entries)
    return " ".join(keyword.split()).upper(), {name.strip().upper(): value.strip(' "') for name, value in pairs}


def _lines(path: Path, including: tuple[Path, ...]) -> Iterator[str]:
    """The lines of a file and of those that it includes, without comments and empty ones."""
    if path in including or not path.is_file():
        raise MeshError(f"the mesh file {path} {'includes itself' if path in including else 'does not exist'}")
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in file:
            if line.lstrip().startswith("**") or not line.strip():
                continue
            other = included(path, line)
            if other is None:
                yield line
            else:
                yield from _lines(other, (*including, path))
