"""Drag that grows with the square of the velocity."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback


@dataclass(frozen=True)
class QuadraticDamping(Feedback):
    """f = e |ẋ| ẋ [Nayfeh1979, Section 3.3]."""

    kind: ClassVar[str] = "quadratic_damping"
    title: ClassVar[str] = "quadratic damping"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit per (output unit/s)²"
    source: ClassVar[str] = "[Nayfeh1979, Section 3.3]"
    on_displacement: ClassVar[bool] = False

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """|ẋ| ẋ."""
        return abs(velocity) * velocity
