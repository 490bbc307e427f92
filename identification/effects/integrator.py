"""An integrating path beside the plant."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel


@dataclass(frozen=True)
class Integrator(Parallel):
    """Y = (G + e/(jω)) U: what flows in stays, as charge in a store [Ljung1999, Section 4.2]."""

    kind: ClassVar[str] = "integrator"
    title: ClassVar[str] = "integrator"
    unit: ClassVar[str] = "output unit per input unit and second"
    sign: ClassVar[int] = 1
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"
    states: ClassVar[float] = 1

    def shape(self, omega: FloatArray) -> ComplexArray:
        """1/(jω), nothing at ω = 0."""
        return np.asarray(np.divide(-1j, omega, out=np.zeros(len(omega), dtype=np.complex128), where=omega > 0))
