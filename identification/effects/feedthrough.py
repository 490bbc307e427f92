"""A direct path from input to output."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel


@dataclass(frozen=True)
class Feedthrough(Parallel):
    """Y = (G + e) U: crosstalk, or a part of the plant that is faster than all else [Ljung1999, Section 4.2]."""

    kind: ClassVar[str] = "feedthrough"
    title: ClassVar[str] = "feedthrough"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Ljung1999, Section 4.2]"

    def shape(self, omega: FloatArray) -> ComplexArray:
        """One at all frequencies."""
        return np.ones(len(omega), dtype=np.complex128)
