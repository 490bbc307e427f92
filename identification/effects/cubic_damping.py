"""Damping that grows with the cube of the velocity."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback


@dataclass(frozen=True)
class CubicDamping(Feedback):
    """f = e ẋ³ [Nayfeh1979, Section 3.3]."""

    kind: ClassVar[str] = "cubic_damping"
    title: ClassVar[str] = "cubic damping"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit per (output unit/s)³"
    source: ClassVar[str] = "[Nayfeh1979, Section 3.3]"
    on_displacement: ClassVar[bool] = False
    curve: ClassVar[str] = "cube"

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """ẋ³."""
        return velocity * velocity * velocity
