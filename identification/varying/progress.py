"""How an estimator says how far it is."""

from collections.abc import Callable

Progress = Callable[[float, str], None]


def silent(fraction: float, message: str) -> None:
    """Nobody listens."""


def within(progress: Progress, start: float, stop: float) -> Progress:
    """Progress of a part: fractions 0 … 1 of it become `start` … `stop` of the whole."""
    return lambda fraction, message: progress(start + (stop - start) * fraction, message)
