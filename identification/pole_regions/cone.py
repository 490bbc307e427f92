"""Sectors with their apex on the real axis: a lower bound of the damping."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError
from identification.pole_regions.half_plane import Side, require_side, side_sign
from identification.pole_regions.inequality import PoleRegion, require_finite


@dataclass(frozen=True)
class Cone(PoleRegion):
    """|Im z| < tan φ · (a − Re z), opening to the left from the apex a (or the mirror image, to the right).

        f(z) = [sin φ (z + z̄ − 2a), cos φ (z − z̄); cos φ (z̄ − z), sin φ (z + z̄ − 2a)]

    In continuous time with a = 0 the damping ratio of every pole is above cos φ.
    """

    kind: ClassVar[str] = "cone"

    half_angle: Annotated[float, "half of the opening angle φ, rad, between 0 and π/2"]
    apex: Annotated[float, "apex a on the real axis"] = 0.0
    side: Annotated[Side, "to which side it opens"] = "left"

    def __post_init__(self) -> None:
        require_finite(self.apex, "apex")
        require_side(self.side)
        if not 0 < self.half_angle < np.pi / 2:
            raise RangeError(f"the half angle is {self.half_angle} rad; it must lie between 0 and π/2", "half_angle")

    @property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, both (2, 2)."""
        s, c, sign = np.sin(self.half_angle), np.cos(self.half_angle), side_sign(self.side)
        return -2 * sign * self.apex * s * np.eye(2), sign * np.array([[s, c], [-c, s]])

    @property
    def real_interval(self) -> tuple[float, float]:
        """(−∞, a) or (a, ∞)."""
        return (-np.inf, self.apex) if self.side == "left" else (self.apex, np.inf)

    @classmethod
    def example(cls) -> "Cone":
        """Damping ratio above one half."""
        return cls(half_angle=np.pi / 3)
