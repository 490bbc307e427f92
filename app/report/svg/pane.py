"""One pair of axes in pixels, and how traces ask it where things stand."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.report.svg.axes import Axis
from identification.arrays import FloatArray

Part = Mapping[str, Any]


@dataclass(frozen=True)
class Box:
    """Where the axes of a figure lie, in pixels from the upper left corner."""

    left: float
    top: float
    width: float
    height: float


@dataclass(frozen=True)
class Pane:
    """A horizontal and a vertical axis inside the box of the figure."""

    horizontal: Axis
    vertical: Axis
    box: Box

    def x(self, values: Sequence[object] | FloatArray) -> FloatArray:
        """Pixels from the left."""
        return np.asarray(self.box.left + self.box.width * self.horizontal.place(values))

    def y(self, values: Sequence[object] | FloatArray) -> FloatArray:
        """Pixels from the top."""
        return np.asarray(self.box.top + self.box.height * (1 - self.vertical.place(values)))

    @property
    def left(self) -> float:
        """Left edge."""
        return self.box.left + self.box.width * self.horizontal.domain[0]

    @property
    def right(self) -> float:
        """Right edge."""
        return self.box.left + self.box.width * self.horizontal.domain[1]

    @property
    def top(self) -> float:
        """Upper edge."""
        return self.box.top + self.box.height * (1 - self.vertical.domain[1])

    @property
    def bottom(self) -> float:
        """Lower edge."""
        return self.box.top + self.box.height * (1 - self.vertical.domain[0])

    def hover(self, name: str, x: object, y: object) -> str:
        """What a mark says of itself."""
        places = [(self.horizontal.title, x), (self.vertical.title, y)]
        said = [f"{title or letter}: {_said(value)}" for letter, (title, value) in zip("xy", places, strict=True)]
        return "\n".join([name, *said] if name else said)


def _said(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, int | float | np.number) else str(value).replace("<br>", " ")
