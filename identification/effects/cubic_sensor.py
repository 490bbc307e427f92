"""A sensor with a cubic part."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Sensor


@dataclass(frozen=True)
class CubicSensor(Sensor):
    """h(y) = y + e y³ [Schoukens2012, Chapter 4]."""

    kind: ClassVar[str] = "cubic_sensor"
    title: ClassVar[str] = "cubic sensor"
    unit: ClassVar[str] = "1 per output unit²"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"

    def shape(self, y: FloatArray) -> FloatArray:
        """y³."""
        return y * y * y
