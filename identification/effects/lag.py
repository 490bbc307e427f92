"""First-order lag."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Factor


@dataclass(frozen=True)
class Lag(Factor):
    """Y = G U/(1 + jωe): a filter, amplifier or sensor of time constant e [Ljung1999, Section 4.2]."""

    kind: ClassVar[str] = "lag"
    title: ClassVar[str] = "first-order lag"
    unit: ClassVar[str] = "s"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    sign: ClassVar[int] = 1
    states: ClassVar[float] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """−jω."""
        return np.asarray(-1j * omega)

    def factor(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """1/(1 + jωe)."""
        return np.asarray(1 / (1 + 1j * omega * e))

    def slope(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """−jω/(1 + jωe)²."""
        return np.asarray(-1j * omega / (1 + 1j * omega * e) ** 2)
