"""A spring that is stiffer one way than the other."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback


@dataclass(frozen=True)
class QuadraticStiffness(Feedback):
    """f = e x² [Nayfeh1979, Section 2.3]."""

    kind: ClassVar[str] = "quadratic_stiffness"
    title: ClassVar[str] = "quadratic stiffness"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit per output unit²"
    source: ClassVar[str] = "[Nayfeh1979, Section 2.3]"

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """x²."""
        return x**2
