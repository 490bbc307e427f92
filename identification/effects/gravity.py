"""A restoring force like that of a pendulum."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Gravity(Feedback):
    """f = e sin(2πx/X), `period` X of the position, as of gravity or of cogging in a motor.

    The position must reach a sixth of the period: a sine that bends less cannot be told from a spring that softens.
    Described in [Nayfeh1979, Section 2.1].
    """

    kind: ClassVar[str] = "gravity"
    title: ClassVar[str] = "sinusoidal restoring force"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Nayfeh1979, Section 2.1]"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("period", "displacement", (0.5, 0.8, 1.2, 2.0, 3.5), highest=6.0),
    )

    period: float = 6.283185307179586

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """sin(2πx/X)."""
        return np.asarray(np.sin(2 * np.pi * x / self.period))
