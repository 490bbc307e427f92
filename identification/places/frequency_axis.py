"""Effects that stretch the axis of frequencies."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.core import Plant, Reshaped
from identification.places.place import Setting
from identification.signals import HeldInput


@dataclass(frozen=True)
class FrequencyAxis(Reshaped):
    """The plant answers as if all frequencies were (1 + e) times as high: Y = G((1 + e) ω) U."""

    place: ClassVar[str] = "axis of frequencies"

    def reshaped(
        self, e: FloatArray, plant: Plant, setting: Setting, omega: FloatArray, held: HeldInput | None
    ) -> ComplexArray:
        """G((1 + e) ω) (M, K) for e (M,), as it is seen through the hold of the input."""
        found = np.empty((len(e), len(omega)), dtype=np.complex128)
        for change in np.unique(e):
            stretched = None if held is None else replace(held, step=held.step / float(1 + change))
            rows = e == change
            found[rows] = plant(setting.zeta, omega * (1 + change), stretched)[rows]
        return found
