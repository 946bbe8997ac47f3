"""The nodes, tetrahedra and their sets of the one part in an Abaqus input file, written so that meshio reads them.

meshio takes the last *NODE block of a file for all of its points, so that a reference point of the assembly replaces
those of the body, and it knows no C3D4H and no types in small letters.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from geometry.errors import MeshError

#: type of an element of a volume with its number of nodes: C3D4, C3D10MH
_VOLUME = re.compile(r"C3D\d+")
#: where lines stand that belong to no part or instance
OUTSIDE = "outside of parts"


def only_body(path: Path) -> tuple[str, list[str]]:
    """An Abaqus file with nodes, elements and their sets of the body alone; points are where the part has them.

    And the set that each block of elements names, empty without one. Raises `MeshError` where several parts or
    instances have elements, or lines are in other files.
    """
    nodes, elements, sets, named = (defaultdict[str, list[str]](list) for _ in range(4))
    instanced, scope = list[str](), OUTSIDE
    for keyword, options, data in _blocks(path):
        if keyword == "INCLUDE" or "INPUT" in options:
            raise MeshError(f"the mesh file {path} has lines in another file ({options.get('INPUT')}); write one file")
        if keyword == "SYSTEM" or (keyword == "NODE" and options.get("SYSTEM", "R").upper() != "R"):
            raise MeshError(f"the mesh file {path} has nodes in a coordinate system of their own; save Cartesian ones")
        if keyword in ("PART", "INSTANCE"):
            scope = options.get("NAME", "")
            instanced.append(options.get("PART", "").lower())
        elif keyword in ("END PART", "END INSTANCE"):
            scope = OUTSIDE
        elif keyword == "NODE":
            nodes[scope] += [",".join(line.split(",")[:4]) for line in data]
        elif keyword == "ELEMENT" and (kind := _VOLUME.match(options.get("TYPE", "").upper())):
            elements[scope] += [f"*ELEMENT, TYPE={kind[0]}", *data]
            named[scope].append(options.get("ELSET", ""))
        elif keyword == "ELSET" and all(re.fullmatch(r"[\d\s,]+", line) for line in data):  # none of other sets
            sets[scope] += [f"*ELSET, ELSET={options.get('ELSET')}{', GENERATE' * ('GENERATE' in options)}", *data]
    bodies = list(elements) or [OUTSIDE]
    if len(bodies) > 1 or instanced.count(bodies[0].lower()) > 1:
        names = ", ".join(bodies)
        raise MeshError(f"the mesh file {path} holds several parts or instances with elements ({names}); save one")
    return "\n".join(["*NODE", *nodes[bodies[0]], *elements[bodies[0]], *sets[bodies[0]], ""]), named[bodies[0]]


def _blocks(path: Path) -> Iterator[tuple[str, dict[str, str], list[str]]]:
    """Keyword, options and lines of data, both names in capitals; what stands before the first keyword is left out."""
    head, data = "", list[str]()
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        if line.lstrip().startswith("**") or not line.strip():
            continue
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
