"""An actuator that saturates."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Actuator
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Saturation(Actuator):
    """g(u) = u + e (clip(u, ± level) − u).

    Beyond `level` the slope falls by the share e; e = 1 is full saturation [Schoukens2012, Chapter 4].
    """

    kind: ClassVar[str] = "saturation"
    title: ClassVar[str] = "actuator saturation"
    unit: ClassVar[str] = "1 (share of the slope lost)"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"
    oversampling: ClassVar[int] = 4
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "input", (0.3, 0.45, 0.6, 0.75, 0.88)),
    )

    level: float = 1.0

    def shape(self, u: FloatArray) -> FloatArray:
        """clip(u, ± level) − u."""
        return np.asarray(np.clip(u, -self.level, self.level) - u)
