"""A spring that hardens (e > 0) or softens (e < 0)."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback


@dataclass(frozen=True)
class CubicStiffness(Feedback):
    """f = e x³ [Nayfeh1979, Section 2.3]."""

    kind: ClassVar[str] = "cubic_stiffness"
    title: ClassVar[str] = "cubic stiffness"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit per output unit³"
    source: ClassVar[str] = "[Nayfeh1979, Section 2.3]"
    curve: ClassVar[str] = "cube"

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """x³."""
        return x * x * x
