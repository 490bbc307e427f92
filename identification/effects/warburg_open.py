"""Diffusion up to a wall."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.linear import Parallel
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class WarburgOpen(Parallel):
    """Y = (G + e coth(√(jωτ))/√(jωτ)) U, τ = `time`.

    Finite length, nothing passes the end [Barsoukov2005, Section 2.1].
    """

    kind: ClassVar[str] = "warburg_open"
    title: ClassVar[str] = "diffusion, blocked end"
    domain: ClassVar[str] = "impedance"
    unit: ClassVar[str] = "output unit per input unit"
    source: ClassVar[str] = "[Barsoukov2005, Section 2.1]"
    states: ClassVar[float] = float("inf")
    sign: ClassVar[int] = 1
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("time", "time", (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)),
    )

    time: float = 1.0

    def shape(self, omega: FloatArray) -> ComplexArray:
        """The impedance for e = 1; nothing at ω = 0."""
        result = np.zeros(len(omega), dtype=np.complex128)
        positive = omega > 0
        root = np.sqrt(1j * omega[positive] * self.time)
        result[positive] = 1 / (root * np.tanh(root))
        return result
