"""A slow leak."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Factor


@dataclass(frozen=True)
class Leak(Factor):
    """Y = jω/(jω + e) G U.

    What the plant shows drains away at the rate e, as in an AC-coupled amplifier [PintelonSchoukens2012,
    Section 2.5].
    """

    kind: ClassVar[str] = "leak"
    title: ClassVar[str] = "leak (high-pass)"
    unit: ClassVar[str] = "rad/s"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.5]"
    sign: ClassVar[int] = 1
    states: ClassVar[float] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """j/ω, nothing at ω = 0."""
        return np.asarray(np.divide(1j, omega, out=np.zeros(len(omega), dtype=np.complex128), where=omega > 0))

    def factor(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """jω/(jω + e); at ω = 0 it is left at one."""
        return np.asarray(1 / (1 - e * self.shape(omega)))

    def slope(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """The derivative of the factor by e."""
        return np.asarray(self.shape(omega) * self.factor(e, omega) ** 2)
