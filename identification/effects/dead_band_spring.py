"""A stop that is reached beyond a gap."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class DeadBandSpring(Feedback):
    """f = e (x − clip(x, ± gap)): a further spring beyond `gap` [Nayfeh1979, Section 3.3]."""

    kind: ClassVar[str] = "dead_band_spring"
    title: ClassVar[str] = "stop beyond a gap"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit per output unit"
    source: ClassVar[str] = "[Nayfeh1979, Section 3.3]"
    oversampling: ClassVar[int] = 4
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("gap", "displacement", (0.3, 0.45, 0.6, 0.75)),
    )

    gap: float = 1.0

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """x − clip(x, ± gap)."""
        return np.asarray(x - np.clip(x, -self.gap, self.gap))
