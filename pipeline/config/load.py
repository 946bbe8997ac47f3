"""A configuration read from a YAML file with units, checked.

A refusal is one sentence for each thing that is wrong: `FILE: key: what is wrong; what is allowed`.
"""

from collections.abc import Sequence
from pathlib import Path

from pipeline.config.config import Config
from pipeline.config.document import Document, read_document
from pipeline.config.section import read


def load_config(path: Path | str, overrides: Sequence[str] = ()) -> Config:
    """The configuration in the YAML file `path` with `overrides` ("mesh.size=4 mm") applied.

    Raises InputError with a sentence for each thing that is wrong, which names the file (or the override), the key and
    what is allowed.
    """
    return checked(read_document(Path(path), overrides))


def checked(document: Document) -> Config:
    """The configuration of a document. Raises InputError."""
    return read(Config, document)
