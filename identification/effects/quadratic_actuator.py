"""An actuator with a quadratic part."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Actuator


@dataclass(frozen=True)
class QuadraticActuator(Actuator):
    """g(u) = u + e u² [Schoukens2012, Chapter 4]."""

    kind: ClassVar[str] = "quadratic_actuator"
    title: ClassVar[str] = "quadratic actuator"
    unit: ClassVar[str] = "1 per input unit"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"

    def shape(self, u: FloatArray) -> FloatArray:
        """u²."""
        return u**2
