"""Why an experiment did not reach a pressure."""

from dataclasses import dataclass

from geometry import Reason


@dataclass(frozen=True)
class Failure:
    """A pressure that an experiment did not reach."""

    pressure_kPa: float
    reason: str  #: a sentence without full stop
    cutbacks: int  #: attempts that failed on the way to it
    factorizations: int  #: of these attempts
    limit_kPa: float = 0.0  #: of a limit point that was found; 0 where none was
    reached_kPa: float = 0.0  #: of the last equilibrium on the way to it
    not_followed: bool = False  #: whether the path was left because of the end of another experiment
    #: whether the path ended before all of the displacement of the end, or of the force on it, was reached
    with_part_of_end: bool = False
    #: whether there is an equilibrium at the pressure, and the body passes through itself in it
    passes_through_itself: bool = False
    causes: tuple[Reason, ...] = ()  #: why the last attempt failed, by the codes of `fem.reasons`

    @property
    def end_kPa(self) -> float:
        """The limit point, else the last equilibrium. Where there is none below a first pressure at which the body
        passes through itself, that pressure, which is an upper bound then. 0 where there is nothing to tell, also where
        the path ended with a part of the displacement or force of the end, which the body may not bear in full."""
        if self.with_part_of_end:
            return 0.0
        first_kPa = self.pressure_kPa if self.passes_through_itself else 0.0
        return self.limit_kPa or self.reached_kPa or first_kPa

    @property
    def brief(self) -> str:
        """The limit or the last equilibrium, where one of them says why the path ended, else the reason."""
        if self.not_followed or self.passes_through_itself or not self.end_kPa:
            return self.reason
        if self.limit_kPa:
            return f"the limit is at {self.limit_kPa:.4g} kPa"
        return f"no equilibrium found beyond {self.reached_kPa:.4g} kPa"
