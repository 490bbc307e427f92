"""Diffusion into a half-space."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel


@dataclass(frozen=True)
class Warburg(Parallel):
    """Y = (G + e (jω)^{−1/2}) U: Warburg impedance [Barsoukov2005, Section 2.1]."""

    kind: ClassVar[str] = "warburg"
    title: ClassVar[str] = "diffusion, infinite length"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit · s^{-1/2}"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """The impedance for e = 1; nothing at ω = 0."""
        result = np.zeros(len(omega), dtype=np.complex128)
        positive = omega > 0
        root = np.sqrt(1j * omega[positive])
        result[positive] = 1 / root
        return result
