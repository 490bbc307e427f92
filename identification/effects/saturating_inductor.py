"""An inductor whose core saturates."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class SaturatingInductor(Feedback):
    """L(i) = e/(1 + (i/I)²) in place of e, I = `level` of the current i = q̇ [Chua1969, Section 1.4].

    f = d/dt (I arctan(q̇/I) − q̇)
    """

    kind: ClassVar[str] = "saturating_inductor"
    title: ClassVar[str] = "saturating inductor"
    domain: ClassVar[str] = "electrical"
    unit: ClassVar[str] = "input unit per rate of the current's unit"
    source: ClassVar[str] = "[Chua1969, Section 1.4]"
    oversampling: ClassVar[int] = 4
    sign: ClassVar[int] = 1
    on_displacement: ClassVar[bool] = False
    differentiated: ClassVar[bool] = True
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("level", "flow", (0.3, 0.7, 1.5), lowest=0.05, highest=5.0),
    )

    level: float = 1.0

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """I arctan(q̇/I) − q̇."""
        return np.asarray(self.level * np.arctan(velocity / self.level) - velocity)
