"""What the sentence says with which an experiment ended: which limit was met, or that nothing explains the end."""

#: says that nothing explains the end, although it has the words "a limit point"
UNEXPLAINED = "neither the law nor a limit point explains it"
#: names the law, in compression and in tension (`fem.outside_stable_range`; the last one up to seed 59)
OF_LAW = ("is no longer stable", "the largest at which the law", "can be trusted at")
#: names a limit: its pressure, a limit point near the last equilibrium, a body that passes through itself
OF_BODY = ("the limit is at", ": a limit point", "passes through itself")
#: what the sentence of an experiment says that ends because II does, whose own sentence decides
BECAUSE_OF_II = (
    "experiment II of the same arm has its limit",
    "limit of experiment II of the same arm",
    "experiment II of the same arm has its last equilibrium",
    "last equilibrium of experiment II of the same arm",
)


def names_a_limit(reason: str) -> bool:
    """Whether a sentence says which limit was met, or that the experiment was not followed because of the end of II."""
    return UNEXPLAINED not in reason and _has(reason, (*OF_LAW, *OF_BODY, *BECAUSE_OF_II))


def names_the_law(reason: str) -> bool:
    """Whether a sentence names the material law as the cause."""
    return _has(reason, OF_LAW)


def names_the_pressure(reason: str) -> bool:
    """Whether a sentence says at which pressure the limit is."""
    return "the limit is at" in reason


def _has(reason: str, phrases: tuple[str, ...]) -> bool:
    return any(phrase in reason for phrase in phrases)
