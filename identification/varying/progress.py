"""How an estimator says how far it is."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

Argument = TypeVar("Argument")
Result = TypeVar("Result")
Progress = Callable[[float, str], None]


def silent(fraction: float, message: str) -> None:
    """Nobody listens."""


def within(progress: Progress, start: float, stop: float) -> Progress:
    """Progress of a part: fractions 0 … 1 of it become `start` … `stop` of the whole."""
    return lambda fraction, message: progress(start + (stop - start) * fraction, message)


@dataclass
class Steps:
    """Progress of something whose number of steps is not known: each takes a tenth of what is left."""

    progress: Progress
    what: str
    count: int = 0

    def of(self, function: Callable[[Argument], Result]) -> Callable[[Argument], Result]:
        """The function, each call of which is a step."""

        def step(argument: Argument) -> Result:
            self.progress(1 - 0.9**self.count, f"{self.what}, step {self.count + 1}")
            self.count += 1
            return function(argument)

        return step
