"""Dry friction."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback

ROUNDING = 0.005


@dataclass(frozen=True)
class CoulombFriction(Feedback):
    """f = e sign ẋ, rounded over half a hundredth of the root mean square velocity [Armstrong1994, Section 2]."""

    kind: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Coulomb friction"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Armstrong1994, Section 2]"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """tanh(ẋ/v₀), v₀ = 0.005 of the root mean square of ẋ."""
        scale = ROUNDING * np.sqrt(np.mean(velocity**2, axis=-1, keepdims=True)) + np.finfo(np.float64).tiny
        return np.asarray(np.tanh(velocity / scale))
