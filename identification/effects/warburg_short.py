"""Diffusion towards a reservoir."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.places.relaxation import Relaxation


@dataclass(frozen=True)
class WarburgShort(Relaxation):
    """Y = (G + e tanh(√(jωτ))/√(jωτ)) U, τ = `time`.

    Finite length, the end held at constant concentration or temperature [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "warburg_short"
    title: ClassVar[str] = "diffusion to an end held constant"

    def impedance(self, s: ComplexArray) -> ComplexArray:
        """tanh(√s)/√s."""
        root = np.sqrt(s)
        return np.asarray(np.tanh(root) / root)
