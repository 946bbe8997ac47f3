"""Recipes: the programs in examples/ as pages and notebooks, with what they printed and drew when they last ran.

`python docs/hooks/recipes.py [NAME...]` runs recipes, all of them without a name, and keeps that in docs/recipes/:
NAME.json has the text that each code cell printed and a hash of the code, NAME.png the picture of the last code cell.
"""

import base64
import contextlib
import hashlib
import io
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import jupytext
from nbformat import NotebookNode, v4

HERE = Path(__file__).resolve().parent.parent.parent
RECIPES, KEPT = HERE / "examples", HERE / "docs" / "recipes"
#: where a recipe leaves its files, from the folder in which it runs; its picture is NAME.png there
RESULTS = Path("results") / "recipes"


def recipes() -> list[str]:
    """Their names."""
    return sorted(path.stem for path in RECIPES.glob("*.py"))


def code_cells(notebook: NotebookNode) -> list[NotebookNode]:
    """Those with code, in their order."""
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def code_hash(notebook: NotebookNode) -> str:
    """Of all code, by which the kept output is known to be that of the present program."""
    return hashlib.sha256("\n\n".join(cell.source for cell in code_cells(notebook)).encode()).hexdigest()


def read(name: str) -> NotebookNode:
    """A recipe without output."""
    notebook = jupytext.read(RECIPES / f"{name}.py")
    notebook.metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return notebook


def run(name: str) -> list[str]:
    """Run a recipe in the present folder: what each of its code cells printed."""
    names: dict[str, Any] = {"__name__": name}
    printed = []
    for number, cell in enumerate(code_cells(read(name))):
        text = io.StringIO()
        with contextlib.redirect_stdout(text):
            exec(compile(cell.source, f"{name}.py, code cell {number + 1}", "exec"), names)
        printed.append(text.getvalue())
    return printed


def keep(name: str, printed: list[str]) -> None:
    """Keep what a recipe printed and drew in the present folder."""
    record = {
        "code": code_hash(read(name)),
        "printed": [[line.rstrip() for line in text.strip("\n").split("\n") if text] for text in printed],
    }
    text = json.dumps(record, indent=1, ensure_ascii=False)
    KEPT.mkdir(exist_ok=True)
    (KEPT / f"{name}.json").write_text(f"{text}\n", encoding="utf-8")
    shutil.copyfile(RESULTS / f"{name}.png", KEPT / f"{name}.png")


def kept(name: str) -> dict[str, Any]:
    """The kept hash of the code, and the printed lines by code cell."""
    record: dict[str, Any] = json.loads((KEPT / f"{name}.json").read_text(encoding="utf-8"))
    return record


def notebook_of(name: str) -> NotebookNode:
    """A recipe as a notebook with its kept output."""
    notebook = read(name)
    cells = code_cells(notebook)
    for cell, lines in zip(cells, kept(name)["printed"], strict=True):
        if lines:
            cell.outputs.append(v4.new_output("stream", name="stdout", text="\n".join(lines) + "\n"))
    picture = base64.b64encode((KEPT / f"{name}.png").read_bytes()).decode()
    cells[-1].outputs.append(v4.new_output("display_data", data={"image/png": picture}))
    return notebook


def page_of(name: str) -> str:
    """A recipe as Markdown with its kept output."""
    parts = []
    for cell in notebook_of(name).cells:
        parts.append(f"```python\n{cell.source}\n```" if cell.cell_type == "code" else cell.source)
        for output in cell.get("outputs", ()):
            is_text = output.output_type == "stream"
            parts.append(f"```text\n{output.text}```" if is_text else f"![What the recipe draws]({name}.png)")
    last = f"This is `examples/{name}.py`, and a [notebook]({name}.ipynb). `make recipes` runs all of them."
    return "\n\n".join([*parts, last, ""])


if __name__ == "__main__":
    if len(sys.argv) == 2:
        keep(sys.argv[1], run(sys.argv[1]))
    else:  # each in a process of its own
        for chosen in sys.argv[1:] or recipes():
            sys.stdout.write(f"examples/{chosen}.py\n")
            sys.stdout.flush()
            subprocess.run([sys.executable, __file__, chosen], check=True)
