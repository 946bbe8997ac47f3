"""Put the convergence studies into the docs: tables between the marks of docs/accuracy.md, pictures beside them.

    python benchmarks/accuracy.py RESULTS

RESULTS has one folder per design, `pneunet_accuracy` and so on, written by `pneurod accuracy`; `make accuracy` makes
all of them first. The table of a design without a folder is not changed.
"""

import json
import re
import sys
from pathlib import Path
from textwrap import fill

HERE = Path(__file__).resolve().parent.parent
# the rooms stand beside this folder
sys.path.insert(0, str(HERE))

from benchmarks.arguments import parser_of  # noqa: E402
from pipeline.accuracy.record import ConvergenceStudy  # noqa: E402
from pipeline.accuracy.table import COLUMNS, cells, order_sentences, reference_sentences  # noqa: E402
from pipeline.store.formats import with_present_keys  # noqa: E402

DOCS = HERE / "docs" / "accuracy.md"
WIDTH = 118  #: characters of a line


def with_tables(text: str, results: Path) -> str:
    """The docs with the table of every design that has results; its marks are `<!-- pneunet -->` and its end."""

    def table(mark: re.Match[str]) -> str:
        name = mark.group(1)
        file = results / f"{name}_accuracy" / "accuracy.json"
        if not file.is_file():
            return mark.group(0)
        study = ConvergenceStudy.read(with_present_keys(json.loads(file.read_text(encoding="utf-8"))))
        sentences = "".join(
            f"{_item(sentence)}\n" for sentence in (*reference_sentences(study), *order_sentences(study))
        )
        picture = f"![error over CPU seconds](pictures/accuracy_{name}.svg)"
        return f"<!-- {name} -->\n\n### {name}\n\n{picture}\n\n{sentences}\n{markdown(study)}\n<!-- end of {name} -->"

    return re.sub(r"<!-- (\w+) -->\n.*?<!-- end of \1 -->", table, text, flags=re.DOTALL)


def _item(sentence: str) -> str:
    """An item of a list, in lines of the docs' length."""
    return fill(sentence, WIDTH, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)


def markdown(study: ConvergenceStudy) -> str:
    """The table of the configurations; those of the Pareto front in bold."""
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---|" + "---:|" * (len(COLUMNS) - 1)]
    for row in study.rows:
        shown = cells(row)
        if row.on_front:
            shown[0] = f"**{shown[0]}**"
        lines.append("| " + " | ".join(shown) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write the docs anew."""
    parser = parser_of(__doc__)
    parser.add_argument("results", type=Path)
    results = parser.parse_args().results
    if not any(results.glob("*_accuracy/accuracy.json")):
        parser.error(f"{results}: has no folder *_accuracy with an accuracy.json; make accuracy makes them")
    DOCS.write_text(with_tables(DOCS.read_text(encoding="utf-8"), results), encoding="utf-8")
    for picture in sorted(results.glob("*_accuracy/accuracy.svg")):
        name = picture.parent.name.removesuffix("_accuracy")
        (HERE / "docs" / "pictures" / f"accuracy_{name}.svg").write_bytes(picture.read_bytes())


if __name__ == "__main__":
    main()
