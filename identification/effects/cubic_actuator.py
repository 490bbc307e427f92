"""An actuator with a cubic part."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Actuator


@dataclass(frozen=True)
class CubicActuator(Actuator):
    """g(u) = u + e u³ [Schoukens2012, Chapter 4]."""

    kind: ClassVar[str] = "cubic_actuator"
    title: ClassVar[str] = "cubic actuator"
    unit: ClassVar[str] = "1 per input unit²"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"

    def shape(self, u: FloatArray) -> FloatArray:
        """u³."""
        return u * u * u
