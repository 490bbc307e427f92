"""A sensor that saturates."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Sensor
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class SensorSaturation(Sensor):
    """h(y) = y + e (clip(y, ± level) − y).

    Beyond `level` the slope falls by the share e [Schoukens2012, Chapter 4].
    """

    kind: ClassVar[str] = "sensor_saturation"
    title: ClassVar[str] = "sensor saturation"
    unit: ClassVar[str] = "1 (share of the slope lost)"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "output", (0.3, 0.45, 0.6, 0.75, 0.88)),
    )

    level: float = 1.0

    def shape(self, y: FloatArray) -> FloatArray:
        """clip(y, ± level) − y."""
        return np.asarray(np.clip(y, -self.level, self.level) - y)
