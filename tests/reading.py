"""What a file of the sources asks its reader to know: names and files that it imports, and how much of it works.

    python -m tests.reading            # the figures of each package and folder (`make reading`)
    python -m tests.reading --lower    # lower the ceilings of tests/data/ceilings.json to what is measured

A ceiling only falls: `tests/test_rooms.py` refuses a figure above its ceiling, and one that is well below it.
"""

import ast
import json
import re
import sys
import tokenize
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from io import StringIO
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

HERE = Path(__file__).resolve().parent.parent
CEILINGS = Path(__file__).resolve().parent / "data" / "ceilings.json"
ROOMS = ("geometry", "fem", "rod", "pipeline", "pneurod")
#: folders whose public names are counted one by one; of the others the most count
COUNTED = (
    *("pipeline/values", "pipeline/config", "pipeline/answers", "pipeline/results", "pipeline/law"),
    *("rod", "rod/arm", "rod/arm_law"),
)
#: classes that are a law of an arm, a rod or its shape; laws of materials, which stand in fem, are none
KINDS = re.compile(r"(Law|Rods?|Rays?|RodSolution|SpatialSolution|Shape)$")
#: words of two letters or more from which on a text is a sentence; lines of a long function
SENTENCE, LONG = 4, 50
#: part by which a figure may lie below its ceiling
SLACK = 0.05

Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class File:
    """One file of the sources, by its path from the root: "fem/model.py"."""

    path: str
    source: str

    @cached_property
    def tree(self) -> ast.Module:
        """Its statements."""
        return ast.parse(self.source)

    @cached_property
    def nodes(self) -> list[ast.AST]:
        """These and all their parts."""
        return list(ast.walk(self.tree))

    @cached_property
    def imports(self) -> list[tuple[str, ast.ImportFrom]]:
        """Every `from ... import`, with the full name of its module."""
        folders = self.path.split("/")[:-1]
        found = [node for node in self.nodes if isinstance(node, ast.ImportFrom)]
        packages = [".".join(folders[: len(folders) + 1 - node.level]) if node.level else "" for node in found]
        return [(".".join(filter(None, (p, node.module))), node) for p, node in zip(packages, found, strict=True)]

    @cached_property
    def own(self) -> list[tuple[str, ast.ImportFrom]]:
        """Those of modules of the project."""
        return [(name, node) for name, node in self.imports if name.partition(".")[0] in ROOMS]

    @cached_property
    def imported(self) -> list[str]:
        """The full names of all modules that it imports, and names that it computes while running."""
        found = [name for name, _ in self.imports]
        for node in self.nodes:
            if isinstance(node, ast.Import):
                found += [alias.name for alias in node.names]
            elif isinstance(node, ast.Name | ast.Attribute):
                name = node.id if isinstance(node, ast.Name) else node.attr
                if name in ("import_module", "__import__"):
                    found.append(f"a name computed while running ({name})")
        return found

    @property
    def names(self) -> int:
        """Names of the project that it imports."""
        return sum(len(node.names) for _, node in self.own)

    @property
    def modules(self) -> int:
        """Files of the project that it imports."""
        return len({name for name, _ in self.own})

    @property
    def unit(self) -> str:
        """Its folder in a package, "pipeline/law", or the package where it stands in no folder."""
        return "/".join(self.path.split("/")[:-1][:2])

    @cached_property
    def functions(self) -> list[Function]:
        """Its functions and methods."""
        return [node for node in self.nodes if isinstance(node, Function)]

    @property
    def inside(self) -> int:
        """Imports that stand inside functions."""
        parts = (node for function in self.functions for node in ast.walk(function))
        return len({node.lineno for node in parts if isinstance(node, ast.Import | ast.ImportFrom)})

    @property
    def kinds(self) -> int:
        """Calls of `isinstance` that ask which law, rod or shape a value is."""
        if self.path.startswith("fem/"):
            return 0
        calls = (node for node in self.nodes if isinstance(node, ast.Call) and isinstance(node.func, ast.Name))
        asked = [call.args[1] for call in calls if isinstance(call.func, ast.Name) and call.func.id == "isinstance"]
        return sum(any(KINDS.search(name) for name in re.findall(r"\w+", ast.unparse(one))) for one in asked)

    @cached_property
    def code(self) -> set[int]:
        """Numbers of the lines with code: neither empty, comment nor docstring."""
        empty = {tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER, tokenize.COMMENT}
        tokens = tokenize.generate_tokens(StringIO(self.source).readline)
        lines = {n for t in tokens if t.type not in empty for n in range(t.start[0], t.end[0] + 1)}
        described = (ast.Module, ast.ClassDef, *Function.__args__)
        for node in self.nodes:
            if isinstance(node, described) and ast.get_docstring(node, clean=False) is not None:
                lines -= _lines(node.body[0])
        return lines

    @cached_property
    def frame(self) -> set[int]:
        """Those of them that do no work: imports, signatures, decorators, fields, constants, raises and sentences."""
        found = {n for node in self.nodes for n in _frame(node)}
        constants = (node for node in self.tree.body if isinstance(node, ast.Assign | ast.AnnAssign))
        return self.code & found.union(*map(_lines, constants))


def _lines(node: ast.stmt | ast.expr) -> set[int]:
    return set(range(node.lineno, (node.end_lineno or node.lineno) + 1))


def _frame(node: ast.AST) -> set[int]:
    """Numbers of the lines of a statement or expression that do no work, without those of its parts."""
    found: set[int] = set()
    if isinstance(node, ast.Import | ast.ImportFrom | ast.Raise):
        found = _lines(node)
    elif isinstance(node, ast.Try | ast.ExceptHandler):
        found = {node.lineno}
    elif isinstance(node, Function):
        found = set(range(node.lineno, node.body[0].lineno)).union(*map(_lines, node.decorator_list))
    elif isinstance(node, ast.ClassDef):
        fields = (line for line in node.body if isinstance(line, ast.AnnAssign))
        found = {node.lineno}.union(*map(_lines, [*node.decorator_list, *fields]))
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        found = _lines(node) if len(re.findall("[A-Za-z]{2,}", node.value)) >= SENTENCE else set()
    return found


@cache
def read_sources() -> tuple[File, ...]:
    """All files of the sources."""
    paths = sorted(path for room in ROOMS for path in (HERE / room).rglob("*.py"))
    return tuple(File(path.relative_to(HERE).as_posix(), path.read_text(encoding="utf-8")) for path in paths)


def imported(source: str, module: str) -> list[str]:
    """The full name of every module that the text of `module` imports, at its top or inside its functions."""
    return File(module, source).imported


def file_imports(files: Iterable[File]) -> dict[str, set[str]]:
    """File -> the other files that it imports, lazy imports included."""
    by_path = {file.path: file for file in files}
    return {path: set(_files_imported(file, by_path)) - {path} for path, file in by_path.items()}


def _files_imported(file: File, known: Mapping[str, File]) -> Iterator[str]:
    names = {f"{name}.{alias.name}" for name, node in file.imports for alias in node.names}
    for name in {*file.imported, *names}:
        path = name.replace(".", "/")
        yield from (one for one in (f"{path}.py", f"{path}/__init__.py") if one in known)


def circles(imports: Mapping[str, set[str]]) -> list[list[str]]:
    """Folders at any depth that import each other in a circle; a file that stands in no folder is one of its own."""
    folders = {path: path.rpartition("/")[0] if path.count("/") > 1 else path for path in imports}
    known = sorted(set(folders.values()))
    arrows = {(known.index(folders[path]), known.index(folders[other])) for path in imports for other in imports[path]}
    rows, columns = np.array([*arrows, (0, 0)]).T
    graph = coo_array((np.ones(len(rows)), (rows, columns)), shape=(len(known), len(known)))
    of = connected_components(graph, connection="strong")[1].tolist()
    groups = [[folder for folder, label in zip(known, of, strict=True) if label == one] for one in set(of)]
    return sorted(group for group in groups if len(group) > 1)


def taken(files: Iterable[File]) -> dict[str, int]:
    """Folder -> how many of its names the files of other folders import, `pneurod` left out."""
    doors: dict[str, set[str]] = {}
    for file in files:
        for name, node in file.own:
            of = "/".join(name.split(".")[:2])
            if of != file.unit and not file.path.startswith("pneurod/"):
                doors.setdefault(of, set()).update(f"{name}.{alias.name}" for alias in node.names)
    folders = {file.unit for file in files}
    return {of: len(names) for of, names in doors.items() if of in folders}


def most_parameters(function: Function) -> int:
    """How many arguments a function has, without `self`."""
    given = function.args
    names = [one.arg for one in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return sum(name not in ("self", "cls") for name in names)


def share_of_work(files: Iterable[File]) -> float:
    """Percent of the lines of code that do work."""
    code, frame = (sum(len(getattr(file, lines)) for file in files) for lines in ("code", "frame"))
    return 100.0 * (1.0 - frame / max(code, 1))


def spread(values: Iterable[int]) -> tuple[int, int, int]:
    """Median, that of nine tenths, and the largest."""
    found = sorted(values) or [0]
    return found[len(found) // 2], found[int(0.9 * len(found))], found[-1]


def measure(files: Sequence[File]) -> dict[str, float]:
    """The figures that have ceilings."""
    found: dict[str, float] = {}
    for room in ROOMS[:4]:
        here = [file for file in files if file.path.startswith(f"{room}/")]
        pages = [file for file in here if not file.path.endswith("__init__.py")]
        found[f"{room}: names that a file imports, nine tenths"] = spread(file.names for file in pages)[1]
        found[f"{room}: files that a file imports, nine tenths"] = spread(file.modules for file in pages)[1]
        found[f"{room}: lines that do no work, %"] = round(100.0 - share_of_work(here))
    doors = taken(files)
    found |= {f"{folder}: public names that others take": doors.get(folder, 0) for folder in COUNTED}
    found["any other folder: public names that others take"] = max(
        (count for folder, count in doors.items() if folder not in COUNTED), default=0
    )
    lengths = [f.end_lineno - f.lineno + 1 for file in files for f in file.functions if f.end_lineno]
    apart = [f for file in files if not file.path.startswith("pipeline/api/") for f in file.functions]
    return found | {
        "isinstance on kinds of law, rod and shape": sum(file.kinds for file in files),
        "circles of folders": len(circles(file_imports(files))),
        "imports inside functions": sum(file.inside for file in files),
        "lines of the longest function": max(lengths, default=0),
        f"functions of more than {LONG} lines": sum(length > LONG for length in lengths),
        "most parameters outside pipeline/api": max(map(most_parameters, apart), default=0),
    }


def complaints(ceilings: Mapping[str, float], figures: Mapping[str, float]) -> list[str]:
    """What lies above its ceiling, and ceilings that are not needed any more; a sentence each."""
    sentences = [f"{name}: has no ceiling or no figure" for name in ceilings.keys() ^ figures.keys()]
    for name in ceilings.keys() & figures.keys():
        ceiling, figure = ceilings[name], figures[name]
        if figure > ceiling:
            sentences.append(f"{name}: {figure:g}, and {ceiling:g} are allowed")
        elif figure < (1.0 - SLACK) * ceiling:
            lower = "`python -m tests.reading --lower` lowers the ceiling"
            sentences.append(f"{name}: {figure:g}, and {ceiling:g} are allowed; {lower}")
    return sorted(sentences)


def read_ceilings() -> dict[str, float]:
    """The figures that may not be exceeded."""
    found: dict[str, float] = json.loads(CEILINGS.read_text(encoding="utf-8"))
    return found


def main(arguments: Sequence[str]) -> int:
    """Print all figures; the exit status is 1 where one is above its ceiling."""
    files = read_sources()
    figures, ceilings = measure(files), read_ceilings()
    if "--lower" in arguments:
        ceilings = {name: min(figure, ceilings.get(name, figure)) for name, figure in figures.items()}
        CEILINGS.write_text(f"{json.dumps(ceilings, indent=2)}\n", encoding="utf-8")
    doors, lines = taken(files), ["names and files of the project that a file imports: median, nine tenths, most"]
    for unit in sorted({file.unit for file in files} | set(ROOMS)):
        here = [file for file in files if file.path.startswith(f"{unit}/")]
        names, modules = (
            "{:>3} {:>3} {:>3}".format(*spread(getattr(file, count) for file in here if "__init__" not in file.path))
            for count in ("names", "modules")
        )
        work = f"work {share_of_work(here):3.0f} %; others take {doors.get(unit, 0):>3}"
        lines.append(f"{unit:24} names {names}   files {modules}   {work}")
    lines += ["", *(f"circle: {', '.join(group)}" for group in circles(file_imports(files))), ""]
    lines += [f"{figure:>6g} of {ceilings.get(name, figure):>6g}  {name}" for name, figure in figures.items()]
    sys.stdout.write("\n".join([*lines, "", *complaints(ceilings, figures), ""]))
    return int(any(figures[name] > ceilings.get(name, figures[name]) for name in figures))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
