"""Command lines of the scripts in this folder: a wrong one is answered in a sentence, with exit status 2."""

import argparse
import math


def parser_of(description: str | None) -> argparse.ArgumentParser:
    """A parser with the docstring of a script as its help."""
    return argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)


def size(text: str) -> float:
    """A size in mm."""
    value = float(text)
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"{text}: give a size above zero, in mm")
    return value


def count(text: str) -> int:
    """How many, at least one."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text}: give 1 or more")
    return value
