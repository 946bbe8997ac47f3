"""Put the ladders of accuracy into the docs: tables between the marks of docs/accuracy.md, pictures beside them.

    python benchmarks/accuracy.py RESULTS

RESULTS holds one folder per design, `pneunet_accuracy` and so on, as `pneurod accuracy` leaves it; `make accuracy`
makes all of them first. A design without a folder keeps what stands in the docs.
"""

import json
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent
# beside this file stands another with the name of a room; the room must be found, not the file
sys.path.insert(0, str(HERE))

from pipeline.accuracy.table import markdown, reference_sentences  # noqa: E402

DOCS = HERE / "docs" / "accuracy.md"


def with_tables(text: str, results: Path) -> str:
    """The docs with the table of every design that has results; its marks are `<!-- pneunet -->` and its end."""

    def table(mark: re.Match[str]) -> str:
        name = mark.group(1)
        file = results / f"{name}_accuracy" / "accuracy.json"
        if not file.is_file():
            return mark.group(0)
        record = json.loads(file.read_text(encoding="utf-8"))
        said = "".join(f"- {sentence}\n" for sentence in reference_sentences(record))
        picture = f"![error over CPU seconds](pictures/accuracy_{name}.svg)"
        return f"<!-- {name} -->\n\n### {name}\n\n{picture}\n\n{said}\n{markdown(record)}\n<!-- end of {name} -->"

    return re.sub(r"<!-- (\w+) -->\n.*?<!-- end of \1 -->", table, text, flags=re.DOTALL)


def main(results: Path) -> None:
    """Write the docs anew."""
    DOCS.write_text(with_tables(DOCS.read_text(encoding="utf-8"), results), encoding="utf-8")
    for picture in sorted(results.glob("*_accuracy/accuracy.svg")):
        name = picture.parent.name.removesuffix("_accuracy")
        (HERE / "docs" / "pictures" / f"accuracy_{name}.svg").write_bytes(picture.read_bytes())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
