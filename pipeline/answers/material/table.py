"""The table of tensile tests in a text file (`pipeline.answers.columns`).

Found by themselves are the lines of titles below metadata and tables of results, a second line of titles, and a line of
units. Titles may be English, German or French.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from pipeline.answers.columns import Column, Columns, Form, Values, plain, read_all
from pipeline.config.units import FORCE, LENGTH, STRAIN, STRESS
from pipeline.values.errors import InputError, argument, quoted

#: words in titles without accents, of columns without a curve of strain or stress, and of the deformed body
_OTHERS = (
    r"rate|speed|geschwindigkeit|vitesse|modul|energ|arbeit|travail|strength|festigkeit|break|bruch|rupture"
    r"|yield|strecksp|streckgr|width|breite|largeur|later|transv|quer|time|zeit|temps|max|peak|\bat\b|\bbei\b"
)
_TRUE = r"\b(true|cauchy|wahr\w*|vrai\w*|log\w*|hencky)\b"
#: words of columns and tests of tension, and of those in which compression is positive
PULLED = re.compile(r"\btens|\bzug|traction")
PRESSED = re.compile(r"compress|stauch|(?<!3d[- ])\bdruck")
#: words of tests in which two sides are held or pulled, and of those to which no law is fitted
STATES = {
    "planar": re.compile(r"\S*(?:\bplanar|pure[- ]shear|reine[rn]? s(?:cher|chub)|cisaillement pur)\S*"),
    "equibiaxial": re.compile(r"\S*(?:bi-?ax|zweiachs)\S*"),
}
NO_TEST = re.compile(r"\S*(?:shear|\bscher|\bschub|cisaill|volumetr|hydrostat)\S*")
NOMINAL = re.compile(r"\beng(\b|ineering)|nominal|technisch|ingenieur")
#: columns of a curve by what they hold
KINDS = {
    name: Column(dimension, words, f"{_OTHERS}|{_TRUE}", without=1.0 if name == "stretch" else np.nan)
    for name, dimension, words in (
        ("stretch", STRAIN, r"stretch|lambda|λ|verstreckung|extension ratio|rapport d.allongement"),
        ("strain", STRAIN, r"strain|dehnung|deformation|verformung|stauchung|allongement|elongation|\beps\w*\b|ε"),
        ("stress", STRESS, r"stress|spannung|contrainte|sigma|σ"),
        ("force", FORCE, r"force|load|kraft|charge|effort|\blast\b|^f$"),
        ("extension", LENGTH, r"extension|displacement|elongation|deformation|crosshead|position|stroke|verlangerung"
                              r"|dehnung|verformung|stauchung|weg\b|deplacement|allongement|^dl$|^δl$"),
    )
}  # fmt: skip
_TEST = (
    r"^(file|datei|fichier|test|specimen|sample|probe|prufling|probekorper|eprouvette|essai)( (name|no\.?|id|nr\.?))?$"
)
_TRUE_CURVE = Column(None, f"(?=.*{_TRUE})(?=.*(?:{'|'.join(column.words for column in KINDS.values())}))", _OTHERS)
TENSILE = Form(
    "tensile tests",
    {
        "test": Column(None, _TEST),
        "loading": Column(None, r"^(loading )?(branch|cycle|zyklus)$"),
        "true": _TRUE_CURVE,
        **KINDS,
    },
    (("stretch", "strain", "extension", "true"), ("stress", "force", "true")),
    "columns of strain and stress, or of extension and force",
    "a line of titles names columns with their units, for example 'strain (%), stress (MPa)'; a hold, and storage and "
    "loss modulus over frequency, are given with --hold",
    title_lines=2,
)
#: largest strain without a unit that is a number; beyond it is in per cent, because no rubber bears so much
LARGEST_STRAIN = 15.0
#: fewest points of a test
MIN_POINTS = 5


@dataclass(frozen=True)
class Specimen:
    """What the tests were made on, where a table has forces and extensions; None where it is not given."""

    length_mm: float | None = None
    area_mm2: float | None = None


@dataclass(frozen=True)
class Series:
    """The points of one test in the order of the file."""

    name: str
    strain: Array  #: (n,)
    stress: Array  #: (n,) MPa
    lines: Array  #: (n,) numbers of their lines
    notes: tuple[str, ...]
    kind: str = ""  #: name and titles in small letters
    state: str = "uniaxial"  #: of `laws.STATES`; empty for a test to which no law is fitted


def read_table(path: Path, specimen: Specimen, state: str = "") -> list[Series]:
    """The tests of a file: by line of titles, pair of columns and name in a column of tests.

    state: of all of them; empty: as names and titles say. Raises InputError.
    """
    tables = _of_curves(path)
    most = max(map(_points, tables))
    pairs = [(table, *pair) for table in tables if _points(table) >= min(most, MIN_POINTS) for pair in _pairs(table)]
    found = [
        series
        for number, (table, *pair, notes) in enumerate(pairs, start=1)
        for series in _series(table, pair, specimen, str(number) if len(pairs) > 1 else "", notes)
    ]
    if state:
        return [replace(series, state=state) for series in found]
    others = [NO_TEST.search(series.kind) for series in found if not series.state]
    words = ", ".join(dict.fromkeys(match[0] for match in others if match))
    kept = [series for series in found if series.state]
    if not kept:
        allowed = "give tension or compression, uniaxial, planar (pure shear) or equibiaxial, or --kind"
        raise InputError(f"{path}: {quoted(words)} is no test to which laws are fitted; {allowed}")
    notes = tuple(dict.fromkeys(text for series in found for text in series.notes))
    if words:
        notes += (f"{path}: {quoted(words)} is left out: laws are fitted to tension, planar or equibiaxial too",)
    return [replace(series, notes=() if number else notes) for number, series in enumerate(kept)]


def _of_curves(path: Path) -> list[Columns]:
    """The tables with columns of nominal strain and stress."""
    tables = read_all(path, TENSILE)
    nominal = [
        table for table in tables if table.all("stretch", "strain", "extension") and table.all("stress", "force")
    ]
    if nominal:
        return nominal
    raise InputError(
        f"{path}: column {quoted(tables[0].all('true')[0].title)} is not nominal; give elongation over length at rest "
        "and force over area at rest"
    )


def _points(table: Columns) -> int:
    """How many rows have two numbers or more."""
    return int((np.isfinite([column.numbers for column in table.known]).sum(axis=0) > 1).sum())


def _pairs(table: Columns) -> list[tuple[Values, Values, tuple[str, ...]]]:
    """Columns of strain and stress, and what is left out beside the first ones."""
    strains = _chosen(table, ("stretch", "strain"), "extension")
    stresses = _chosen(table, ("stress",), "force")
    if len(strains) == len(stresses):
        return [(strain, stress, ()) for strain, stress in zip(strains, stresses, strict=True)]
    states = [_state(plain(column.title)) for column in stresses]
    if len(strains) == 1 and len(set(states)) == len(states):
        return [(strains[0], stress, ()) for stress in stresses]
    strains, stresses = (
        [column for column in columns if _state(plain(column.title)) == "uniaxial"] or columns
        for columns in (strains, stresses)
    )
    taken = f"'{strains[0].title}' and '{stresses[0].title}'"
    note = f"{table.path}: the columns {taken} are taken, other columns of strain and stress are not"
    return [(strains[0], stresses[0], (note,))]


def _series(
    table: Columns, pair: Sequence[Values], specimen: Specimen, number: str, notes: tuple[str, ...]
) -> Iterator[Series]:
    """The tests of a pair of columns."""
    values = [_values(table, column, specimen) for column in pair]
    known = np.isfinite(values[0][0]) & np.isfinite(values[1][0])
    notes += tuple(note for _, note in values if note)
    if not known.any():
        raise InputError(f"{table.path}: has titles and no numbers under them; give a row for each point")
    lines = table.lines[known]
    if gaps := int(lines[-1] - lines[0]) + 1 - len(lines):
        notes += (f"{table.path}: {gaps} rows between points have no numbers and are left out",)
    names = np.full(len(lines), number)
    if tests := table.all("test"):
        column = tests[0].cells
        last = np.maximum.accumulate(np.where(column != "", np.arange(len(column)), 0))  # the last that is not empty
        names = np.array([f"{name} {number}".strip() for name in column[last][known]])
    first = np.ones(len(lines), dtype=bool)
    if loadings := [column.cells[known] for column in table.all("loading")]:
        first = np.array([loadings[0][k] == loadings[0][names == name][0] for k, name in enumerate(names)])
        if not first.all():
            other = ", ".join(dict.fromkeys(loadings[0][~first].tolist()))
            notes += (f"{table.path}: loading {quoted(other)} is left out; the first one of each test is used",)
    for name in dict.fromkeys(names.tolist()):
        kind, of_test = plain(" ".join([name, *(column.title for column in pair)])), first & (names == name)
        strain, stress = (column[known][of_test] for column, _ in values)
        if PRESSED.search(kind):
            strain, stress = (-column if np.median(column) > 0 else column for column in (strain, stress))
        if (impossible := strain <= -1).any():
            line, value = lines[of_test][impossible][0], 100 * strain[impossible][0]
            raise InputError(f"{table.path}: line {line}: {value:g} % is no possible strain; allowed: above -100 %")
        yield Series(name, strain, stress, lines[of_test], notes, kind, _state(kind))
        notes = ()


def _state(kind: str) -> str:
    """The state that words in small letters name; empty for one to which no law is fitted."""
    named = next((state for state, words in STATES.items() if words.search(kind)), "uniaxial")
    return "" if named == "uniaxial" and NO_TEST.search(kind) else named


def _values(table: Columns, column: Values, specimen: Specimen) -> tuple[Array, str]:
    """(rows,) strains or stresses in MPa, and what is assumed about them."""
    if column.problem and column.name == "strain" and not column.unit:
        largest = float(np.nanmax(np.abs(column.numbers), initial=0.0))
        unit, name = (1.0, "1") if largest <= LARGEST_STRAIN else (0.01, "%")
        note = f"{table.path}: column '{column.title}' has no unit and reaches {largest:.3g}; it is read in {name}"
        return unit * column.numbers, note
    table.check(column)
    if column.name not in ("extension", "force"):
        return column.numbers - (column.name == "stretch"), ""
    is_force = column.name == "force"
    size = specimen.area_mm2 if is_force else specimen.length_mm
    if size is None:
        area, length = argument("area", "'16 mm^2'"), argument("length", "'33 mm'")
        needed = f"{area}, the cross-section" if is_force else f"{length}, the length"
        raise InputError(f"{table.path}: column '{column.title}' holds {column.name}s; give {needed} at rest")
    return column.numbers / size, ""


def _chosen(table: Columns, kinds: Sequence[str], otherwise: str) -> list[Values]:
    """The columns of one quantity: those that are called nominal where any is."""
    found = table.all(*kinds) or table.all(otherwise)
    return [column for column in found if NOMINAL.search(plain(column.title))] or found
