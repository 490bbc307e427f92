"""A further RC arc."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.places.relaxation import Relaxation


@dataclass(frozen=True)
class RcArc(Relaxation):
    """Y = (G + e/(1 + jωτ)) U, τ = `time`.

    A resistance e with a capacitance beside it [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "rc_arc"
    title: ClassVar[str] = "extra RC arc"
    states: ClassVar[float] = 1

    def impedance(self, s: ComplexArray) -> ComplexArray:
        """1/(1 + s)."""
        return np.asarray(1 / (1 + s))
