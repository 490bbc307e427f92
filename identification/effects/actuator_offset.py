"""A constant added by the actuator."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Actuator


@dataclass(frozen=True)
class ActuatorOffset(Actuator):
    """g(u) = u + e [PintelonSchoukens2012, Section 2.4]."""

    kind: ClassVar[str] = "actuator_offset"
    title: ClassVar[str] = "actuator offset"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"

    def shape(self, u: FloatArray) -> FloatArray:
        """One at all times."""
        return np.ones_like(u)
