"""A constant added by the sensor."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Added


@dataclass(frozen=True)
class SensorOffset(Added):
    """y + e [PintelonSchoukens2012, Section 2.4]."""

    kind: ClassVar[str] = "sensor_offset"
    title: ClassVar[str] = "sensor offset"
    unit: ClassVar[str] = "output unit"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"

    def signal(self, time: FloatArray) -> FloatArray:
        """One at all times."""
        return np.ones((1, len(time)))
