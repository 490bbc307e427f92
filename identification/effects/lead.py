"""First-order lead."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Factor


@dataclass(frozen=True)
class Lead(Factor):
    """Y = (1 + jωe) G U.

    A zero at −1/e, such as a sensor that also shows the rate of change [Ljung1999, Section 4.2].
    """

    kind: ClassVar[str] = "lead"
    title: ClassVar[str] = "first-order lead"
    unit: ClassVar[str] = "s"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    sign: ClassVar[int] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """jω."""
        return np.asarray(1j * omega)
