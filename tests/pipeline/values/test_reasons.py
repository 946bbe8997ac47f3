"""Every reason has a sentence of at most 25 words, in which nothing is left open."""

import ast
import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from string import Formatter

import pytest

from fem.reasons import SENTENCES
from geometry import Reason
from pipeline.store.result_folder import json_text
from pipeline.values.reasons import NO_PARAMETERS, TEMPLATES, render, report_reason

ROOT = Path(__file__).resolve().parent.parent.parent.parent


def reasons_in_sources() -> Iterator[tuple[set[str], set[str] | None]]:
    """The codes of each `Reason` that a source file makes, and its values where all of their names stand there."""
    for room in ("geometry", "rod", "pipeline"):
        for path in sorted((ROOT / room).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Reason") and node.args:
                    constants = [n.value for n in ast.walk(node.args[0]) if isinstance(n, ast.Constant)]
                    yield {code for code in constants if isinstance(code, str)}, names_of(node.args[1:])


def names_of(arguments: list[ast.expr]) -> set[str] | None:
    if arguments and isinstance(arguments[0], ast.Dict):
        keys = arguments[0].keys
        return {k.value for k in keys if isinstance(k, ast.Constant)} if all(keys) else None
    return None if arguments else set()


def fields_of(code: str) -> dict[str, str]:
    """The fields of a template and how each is written."""
    return {name: spec or "" for _, name, spec, _ in Formatter().parse({**SENTENCES, **TEMPLATES}[code]) if name}


def test_every_reason_that_is_made_has_a_template_with_fields_that_it_fills() -> None:
    made = list(reasons_in_sources())
    codes_made = set().union(*(codes for codes, _ in made))
    assert set(TEMPLATES) <= codes_made <= {*TEMPLATES, *SENTENCES}
    assert set(NO_PARAMETERS) < set(TEMPLATES)
    checked = 0
    for codes, names in made:
        if names is not None:
            checked += 1
            assert all(set(fields_of(code)) - {"at"} <= names for code in codes), codes
    assert checked > 15


@pytest.mark.parametrize("code", TEMPLATES)
def test_a_template_is_one_short_sentence(code: str) -> None:
    values = {name: 1.5 if spec else "word" for name, spec in fields_of(code).items() if name != "at"}
    text = render(Reason(code, values, (1.0, 2.0, 3.0)))
    assert "{" not in text
    assert len(TEMPLATES[code].split()) <= 25
    assert not text.endswith(".")
    assert ("(1.0, 2.0, 3.0) mm" in text) == ("at" in fields_of(code))
    assert json.loads(json_text(asdict(report_reason(Reason(code, values))))) if "at" not in fields_of(code) else True
