"""Transport delay."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Factor


@dataclass(frozen=True)
class Delay(Factor):
    """Y = e^{−jωe} G U: everything arrives later by e seconds [Ljung1999, Section 4.2]."""

    kind: ClassVar[str] = "delay"
    title: ClassVar[str] = "delay"
    unit: ClassVar[str] = "s"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    sign: ClassVar[int] = 1
    states: ClassVar[float] = float("inf")

    def shape(self, omega: FloatArray) -> ComplexArray:
        """−jω."""
        return np.asarray(-1j * omega)

    def factor(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """e^{−jωe}."""
        return np.asarray(np.exp(-1j * omega * e))

    def slope(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """−jω e^{−jωe}."""
        return np.asarray(-1j * omega * np.exp(-1j * omega * e))
