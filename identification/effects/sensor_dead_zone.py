"""A sensor with a dead zone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Sensor
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class SensorDeadZone(Sensor):
    """h(y) = y − e clip(y, ± level): within `level` the slope falls by the share e [Schoukens2012, Chapter 4]."""

    kind: ClassVar[str] = "sensor_dead_zone"
    title: ClassVar[str] = "sensor dead zone"
    unit: ClassVar[str] = "1 (share of the slope lost)"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "output", (0.02, 0.05, 0.1, 0.2, 0.35, 0.5)),
    )

    level: float = 0.1

    def shape(self, y: FloatArray) -> FloatArray:
        """−clip(y, ± level)."""
        return np.asarray(-np.clip(y, -self.level, self.level))
