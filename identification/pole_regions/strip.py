"""Strips along the real axis: an upper bound of the frequency of oscillation."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.pole_regions.inequality import PoleRegion, require_finite


@dataclass(frozen=True)
class Strip(PoleRegion):
    """|Im z| < h, the horizontal strip about the real axis (a vertical one is two half-planes intersected).

    f(z) = [−2h, z − z̄; z̄ − z, −2h]
    """

    kind: ClassVar[str] = "strip"

    half_height: Annotated[float, "half of the strip's height h > 0; rad/s in continuous time"]

    def __post_init__(self) -> None:
        require_finite(self.half_height, "half_height", positive=True)

    @property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, both (2, 2)."""
        return -2 * self.half_height * np.eye(2), np.array([[0.0, 1.0], [-1.0, 0.0]])

    @property
    def real_interval(self) -> tuple[float, float]:
        """(−∞, ∞)."""
        return -np.inf, np.inf

    @classmethod
    def example(cls) -> "Strip":
        """A strip of height one."""
        return cls(half_height=0.5)
