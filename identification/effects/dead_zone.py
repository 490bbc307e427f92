"""An actuator with a dead zone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Actuator
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class DeadZone(Actuator):
    """g(u) = u − e clip(u, ± level).

    Within `level` the slope falls by the share e; e = 1 is a full dead zone [Schoukens2012, Chapter 4].
    """

    kind: ClassVar[str] = "dead_zone"
    title: ClassVar[str] = "actuator dead zone"
    unit: ClassVar[str] = "1 (share of the slope lost)"
    source: ClassVar[str] = "[Schoukens2012, Chapter 4]"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    largest: ClassVar[float | None] = 1.5
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "input", (0.02, 0.05, 0.1, 0.2, 0.35, 0.5)),
    )

    level: float = 0.1

    def shape(self, u: FloatArray) -> FloatArray:
        """−clip(u, ± level)."""
        return np.asarray(-np.clip(u, -self.level, self.level))
