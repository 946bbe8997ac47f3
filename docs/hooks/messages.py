"""The page of all messages: notes and failures of runs, and every sentence with which the program refuses input."""

import ast
import html
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from fem.reasons import SENTENCES
from pipeline.values.reasons import TEMPLATES

HEADER = """# Messages

Notes and failures of runs by their `code` in `run.json`, then every sentence with which the program refuses an input or
ends a computation, in the order of the source files. Words in brackets stand for values that are known only when it
happens.
"""
TITLES = {
    "geometry": "The body: dimensions, CAD files, meshes",
    "fem": "The finite elements",
    "rod": "The rod and its parameters",
    "pipeline": "Configurations, runs, files",
    "pneurod": "The Python interface",
}
#: errors that only a fault of the program itself would show
INTERNAL = {"AssertionError", "AttributeError", "NotImplementedError", "StaleFactorization", "TypeError"}


class Message(NamedTuple):
    """A sentence, the error it belongs to, and the source file."""

    sentence: str
    error: str
    path: str


def messages_page(root: Path) -> str:
    """The page as Markdown, from the packages in the folder `root`."""
    by_code = {"Notes and failures of a run": TEMPLATES, "Why a load path ends, or what limits a state": SENTENCES}
    coded = [line for title, texts in by_code.items() for line in _table(title, ("code", "sentence"), _coded(texts))]
    raised = [line for room in TITLES for line in _table(TITLES[room], Message._fields, _messages_in(root, room))]
    return "\n".join([HEADER, *coded, *raised])


def _coded(texts: Mapping[str, str]) -> list[tuple[str, ...]]:
    return [(f"`{code}`", _safe(re.sub(r"{(\w+)[^}]*}", r"<\1>", text))) for code, text in texts.items()]


def _table(title: str, columns: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    lines = [columns, ("---",) * len(columns), *rows]
    return [f"## {title}", "", *(f"| {' | '.join(line)} |" for line in lines), ""]


def _messages_in(root: Path, room: str) -> list[tuple[str, ...]]:
    found = [message for path in sorted((root / room).rglob("*.py")) for message in messages_of(path, root / room)]
    return [*dict.fromkeys(found)]


def messages_of(path: Path, root: Path) -> Iterator[Message]:
    """The messages of one source file, in their order there."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    for function in (node for node in nodes if isinstance(node, ast.FunctionDef)):
        inside = list(ast.walk(function))
        parts = {n.targets[0].id: n.value for n in inside if isinstance(n, ast.Assign) and _is_text(n)}
        for node in inside:
            if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
                error = ast.unparse(node.exc.func).rpartition(".")[2]
                # a key of the configuration may come before the sentence
                texts = (_sentence(given, parts) for given in node.exc.args[:2])
                sentence = next((text for text in texts if " " in text), "")
                if sentence and error not in INTERNAL:
                    yield Message(_safe(sentence), error, str(path.relative_to(root)))


def _is_text(node: ast.Assign) -> bool:
    """Whether a name is given to a part of a sentence."""
    return isinstance(node.targets[0], ast.Name) and " " in _sentence(node.value, {})


def _sentence(node: ast.expr, parts: Mapping[str, ast.expr]) -> str:
    """The text of a string or of a formatted string; empty for anything else. parts: of sentences, by their names."""
    match node:
        case ast.Name(id=name) | ast.FormattedValue(value=ast.Name(id=name)) if name in parts:
            return _sentence(parts[name], {})
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=values):
            return "".join(_sentence(value, parts) for value in values)
        case ast.FormattedValue(value=value):  # the last name in it
            name = re.findall(r"[A-Za-z]\w*", ast.unparse(value))[-1]
            return f"<{name.replace('_', ' ')}>"
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _sentence(left, parts) + _sentence(right, parts)
    return ""


def _safe(text: str) -> str:
    """The text without characters that Markdown or a table would interpret."""
    return re.sub(r"([|\[*])", r"\\\1", html.escape(text, quote=False)).replace("\n", " ")
