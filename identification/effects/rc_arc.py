"""A further RC arc."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class RcArc(Parallel):
    """Y = (G + e/(1 + jωτ)) U, τ = `time`.

    A resistance e with a capacitance beside it [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "rc_arc"
    title: ClassVar[str] = "extra RC arc"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = 1
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("time", "time", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)),
    )

    time: float = 1.0

    def shape(self, omega: FloatArray) -> ComplexArray:
        """1/(1 + jωτ)."""
        return np.asarray(1 / (1 + 1j * omega * self.time))
