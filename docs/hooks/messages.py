"""The page of all messages: every sentence with which the program refuses input or ends, read from its sources."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

HEADER = """# Messages

Every sentence with which the program refuses an input or ends a computation, in the order of the source files. Words in
angle brackets stand for values that are known only when it happens.
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
    return "\n".join([HEADER, *(_section(root, package) for package in TITLES)])


def _section(root: Path, package: str) -> str:
    messages = [message for path in sorted((root / package).rglob("*.py")) for message in messages_of(path, root)]
    rows = [f"| {m.sentence} | {m.error} | {m.path.partition('/')[2]} |" for m in dict.fromkeys(messages)]
    head = [f"## {TITLES[package]}", "", "| message | error | source |", "|---|---|---|"]
    return "\n".join([*head, *rows, ""])


def messages_of(path: Path, root: Path) -> Iterator[Message]:
    """The messages of one source file, in their order there."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Raise) or not isinstance(node.exc, ast.Call) or not node.exc.args:
            continue
        error = ast.unparse(node.exc.func).rpartition(".")[2]
        texts = [_sentence(argument) for argument in node.exc.args[:2]]
        keyed = len(texts) == 2 and texts[0] and " " not in texts[0]  # a key of the configuration, then the sentence
        sentence = f"`{texts[0]}`: {texts[1]}" if keyed else texts[0]
        if " " in sentence and error not in INTERNAL:
            yield Message(sentence, error, str(path.relative_to(root)))


def _sentence(node: ast.expr) -> str:
    """The text of a string or of a formatted string; empty for anything else."""
    match node:
        case ast.Constant(value=str(text)):
            return _safe(text)
        case ast.JoinedStr(values=parts):
            return "".join(_part(part) for part in parts)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return _sentence(left) + _sentence(right)
    return ""


def _part(node: ast.expr) -> str:
    return f"&lt;{_name(node.value)}&gt;" if isinstance(node, ast.FormattedValue) else _sentence(node)


def _name(node: ast.expr) -> str:
    """A word for the value of an expression: the last name in it that is not a function."""
    functions = {id(call.func) for call in ast.walk(node) if isinstance(call, ast.Call)}
    names = [n for n in ast.walk(node) if isinstance(n, (ast.Name, ast.Attribute)) and id(n) not in functions]
    words = [n.attr if isinstance(n, ast.Attribute) else n.id for n in names]
    counted = isinstance(node, ast.Call) and ast.unparse(node.func) == "len"
    word = next((word for word in words if word not in ("self", "np")), "value").strip("_").replace("_", " ")
    return f"number of {word}" if counted else word


def _safe(text: str) -> str:
    """The text without characters that Markdown or a table would interpret."""
    for plain, escaped in (("|", "\\|"), ("<", "&lt;"), (">", "&gt;"), ("[", "\\["), ("*", "\\*"), ("\n", " ")):
        text = text.replace(plain, escaped)
    return text
