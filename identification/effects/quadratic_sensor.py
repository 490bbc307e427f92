"""A sensor with a quadratic part."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.nonlinear import Sensor


@dataclass(frozen=True)
class QuadraticSensor(Sensor):
    """h(y) = y + e y² [Schoukens2012, Chapter 4]."""

    kind: ClassVar[str] = "quadratic_sensor"
    title: ClassVar[str] = "quadratic sensor"
    unit: ClassVar[str] = "1 per output unit"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"

    def shape(self, y: FloatArray) -> FloatArray:
        """y²."""
        return y**2
