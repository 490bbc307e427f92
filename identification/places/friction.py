"""Dry friction, and the sign of a velocity on a time grid."""

from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np

from identification.arrays import FloatArray
from identification.places.nonlinear import Feedback

ROUNDING = 0.005


def sign(velocity: FloatArray, rounding: float = ROUNDING) -> FloatArray:
    """sign v (…, L) as its mean over each step of a periodic time grid, v taken as straight within the step.

        clip(v/w, ±1),   w the larger of half the change of v over the step and `rounding` of its root mean square

    A jump between two samples would otherwise fall on one of them and put its highest lines at the wrong phase.
    """
    change = abs(np.roll(velocity, -1, axis=-1) - np.roll(velocity, 1, axis=-1)) / 4
    rounded = rounding * np.sqrt(np.mean(velocity**2, axis=-1, keepdims=True)) + np.finfo(np.float64).tiny
    return np.asarray(np.clip(velocity / np.maximum(change, rounded), -1.0, 1.0))


@dataclass(frozen=True)
class Friction(Feedback):
    """f = e (m(|q̇|) sign q̇ + a) [Armstrong1994, Section 2]: m and a are one and zero unless overridden.

    `rounding`: below this share of the root mean square of q̇ the sign is rounded off, so that what sticks creeps.
    """

    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Armstrong1994, Section 2]"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    on_displacement: ClassVar[bool] = False
    at_once: ClassVar[bool] = False

    rounding: float = field(default=ROUNDING, kw_only=True)

    def rounded(self, width: float) -> Self:
        """With a sign that turns over more of the velocity."""
        return replace(self, rounding=max(self.rounding, width))

    def size(self, velocity: FloatArray) -> FloatArray:
        """m (M, L), or what it is at every velocity."""
        return np.ones(1)

    @property
    def offset(self) -> float:
        """a."""
        return 0.0

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """m sign q̇ + a, the sign as its mean over each step of the time grid."""
        return np.asarray(self.size(velocity) * sign(velocity, self.rounding) + self.offset)

    def held_against(self, q: FloatArray, flow: FloatArray, e: FloatArray, by: FloatArray) -> FloatArray:
        """All of it where that leaves the direction as it is, else what brings the mass to rest."""
        size = e * self.size(flow)
        stopping = size * by[1] + np.finfo(np.float64).tiny
        return np.asarray(size * np.clip((flow - by[1] * e * self.offset) / stopping, -1.0, 1.0) + e * self.offset)
