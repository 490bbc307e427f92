"""Rate-independent hysteresis."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.memory import dahl
from identification.places.nonlinear import Feedback
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class Hysteresis(Feedback):
    """f = e z, dz = (dx − |dx| z)/δ, δ = `travel`: Bouc–Wen with n = 1 and γ = 0, Dahl friction [Wen1976, (3)].

    For δ → 0 it becomes Coulomb friction, which is another effect: δ is kept above a fiftieth of the largest output.
    """

    kind: ClassVar[str] = "hysteresis"
    title: ClassVar[str] = "hysteresis (Bouc–Wen)"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Wen1976, (3)]"
    states: ClassVar[float] = 1
    remembers: ClassVar[bool] = True
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("travel", "displacement", (0.05, 0.15, 0.4, 1.0), lowest=0.02),
    )

    travel: float = 1.0

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """z."""
        return dahl(x, self.travel)

    def slopes(self, x: FloatArray, velocity: FloatArray) -> tuple[FloatArray, FloatArray]:
        """None that belong to a moment: the state remembers."""
        return np.zeros_like(x), np.zeros_like(x)
