"""Where a value stands along an axis, and where its ticks are."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np

from app.report.svg.elements import number_label
from identification.arrays import FloatArray

Tick = tuple[float, str]


@dataclass(frozen=True)
class Scale:
    """A `kind` of axis ("linear", "log", "category") from `low` to `high`, which are logarithms of a log axis.

    Categories stand at 0, 1, … . `low` beyond `high` is an axis that runs backwards.
    """

    kind: str
    low: float
    high: float
    categories: tuple[str, ...] = ()

    def share(self, values: Sequence[object] | FloatArray) -> FloatArray:
        """Places between 0 (`low`) and 1 (`high`); not a number where there is none, as for zero on a log axis."""
        span = self.high - self.low
        return np.asarray((self.coordinates(values) - self.low) / span)

    def coordinates(self, values: Sequence[object] | FloatArray) -> FloatArray:
        """Values, their logarithms, or the numbers of categories."""
        return coordinates(values, self.kind, self.categories)

    def ticks(self, most: int) -> list[Tick]:
        """At most about so many places with labels: round numbers, decades, or all categories."""
        low, high = sorted((self.low, self.high))
        if self.kind == "category":
            return [(float(i), name) for i, name in enumerate(self.categories)]
        if self.kind == "log":
            return _decades(low, high, most)
        step = _step((high - low) / max(most, 1))
        first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
        return [(i * step, number_label(i * step)) for i in range(first, last + 1)]


def coordinates(values: Sequence[object] | FloatArray, kind: str, categories: Sequence[str] = ()) -> FloatArray:
    """Values as they stand on a kind of axis, before it is known from where to where it goes.

    Categories by their names; a number that names none is a place between them.
    """
    if kind == "category":
        places: dict[str, object] = {name: i for i, name in enumerate(categories)}
        return np.array([places.get(str(value), value) for value in values], dtype=float)
    numbers = np.array([np.nan if value is None else value for value in values], dtype=float)
    if kind == "log":
        return np.log10(np.where(numbers > 0, numbers, np.nan))
    return numbers


def _decades(low: float, high: float, most: int) -> list[Tick]:
    powers = range(ceil(low - 1e-9), floor(high + 1e-9) + 1)
    if len(powers) > 2:
        step = max(ceil((high - low) / max(most, 1)), 1)
        return [(float(power), number_label(10.0**power)) for power in powers if power % step == 0]
    marks = [digit * 10.0**power for power in range(floor(low), ceil(high) + 1) for digit in (1, 2, 5)]
    inside = [(log10(mark), number_label(mark)) for mark in marks if low - 1e-9 <= log10(mark) <= high + 1e-9]
    if len(inside) >= 2:
        return inside
    linear = Scale("linear", 10.0**low, 10.0**high)
    return [(log10(value), label) for value, label in linear.ticks(min(most, 5)) if value > 0]


def _step(least: float) -> float:
    """The smallest of 1, 2, 5 times a power of ten that is not below `least`."""
    power = 10.0 ** floor(log10(least))
    return next(digit * power for digit in (1, 2, 5, 10) if digit * power >= least * (1 - 1e-9))
