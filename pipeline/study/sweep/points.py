"""The points of a sweep: their values, their folders, and their configurations or why these are refused."""

import hashlib
import re
from dataclasses import dataclass

from pipeline.config.config import Config
from pipeline.config.load import checked, for_command
from pipeline.simulate.simulate import why_not_free
from pipeline.study.sweep.axes import Setting, switch_as_word
from pipeline.study.sweep.spec import CELL, Run, Sweep, document_of
from pipeline.values.errors import ConflictError, InputError
from pipeline.values.reasons import render

#: characters of the values in the name of a folder
LONGEST_NAME = 60


@dataclass(frozen=True)
class Point:
    """A design of a sweep."""

    number: int  #: from 1 on, in the order of the axes
    setting: Setting  #: the values of the axes
    config: Config

    @property
    def name(self) -> str:
        """The name of its folder: its values, and a part of the hash of its configuration.

        It does not depend on the other points, so that a sweep with more points keeps the folders of the earlier ones.
        """
        values = "_".join(f"{key.rpartition('.')[2]}={switch_as_word(value)}" for key, value in self.setting.items())
        readable = re.sub(r"[^A-Za-z0-9.=+_-]", "", values)[:LONGEST_NAME]
        return f"{readable}_{self.config.hash[:8]}"

    def work_key(self, sources_key: str, run: Run) -> str:
        """sha256 of what decides its result: sources and packages, configuration, and what is run."""
        return hashlib.sha256(
            "|".join((sources_key, self.config.hash, *["draft"] * self.config.draft, *run)).encode()
        ).hexdigest()


@dataclass(frozen=True)
class RefusedPoint:
    """A point whose configuration is refused."""

    number: int
    setting: Setting
    reason: str  #: one sentence


def points_of(sweep: Sweep) -> list[Point | RefusedPoint]:
    """All points in the order of the axes.

    Raises InputError where a value of an axis is refused at every point that has it, as an unknown key or a wrong unit
    is, and where no point at all is left.
    """
    unchecked: dict[int, InputError] = {}
    points: list[Point | RefusedPoint] = []
    for number, setting in enumerate(sweep.settings, start=1):
        try:
            document = document_of(sweep, setting)
            try:
                config, _ = for_command(CELL if sweep.run == (CELL,) else "run", document, checked)
            except InputError as failure:
                if not isinstance(failure, ConflictError):
                    unchecked[number] = failure
                raise
            if sweep.run == ("I",) and (reason := why_not_free(config)):
                raise InputError(f"{render(reason)}, and run names no other one")
            points.append(Point(number, setting, config))
        except InputError as failure:
            points.append(RefusedPoint(number, setting, "; ".join(failure.sentences)))
    _refuse_axes(sweep, unchecked)
    refused = [point for point in points if isinstance(point, RefusedPoint)]
    if len(refused) == len(points):
        raise InputError(f"every point of {sweep.source} is refused; the first one: {refused[0].reason}")
    return points


def _refuse_axes(sweep: Sweep, unchecked: dict[int, InputError]) -> None:
    """Raise the refusal of a value of an axis that no point can have."""
    for value in (value for axis in sweep.axes for value in axis.settings if unchecked):
        having = [
            number
            for number, setting in enumerate(sweep.settings, start=1)
            if all(setting[key] == entry for key, entry in value.items())
        ]
        if having and all(number in unchecked for number in having):
            raise unchecked[having[0]]
