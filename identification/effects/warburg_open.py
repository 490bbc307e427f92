"""Diffusion up to a wall."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray
from identification.places.relaxation import Relaxation


@dataclass(frozen=True)
class WarburgOpen(Relaxation):
    """Y = (G + e coth(√(jωτ))/√(jωτ)) U, τ = `time`.

    Finite length, nothing passes the end [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "warburg_open"
    title: ClassVar[str] = "diffusion, open circuit (blocked end)"
    at_rest: ClassVar[float] = 0.0

    def impedance(self, s: ComplexArray) -> ComplexArray:
        """coth(√s)/√s."""
        root = np.sqrt(s)
        return np.asarray(1 / (root * np.tanh(root)))
