"""Dry friction."""

from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import FloatArray
from identification.places.friction import sign
from identification.places.nonlinear import Feedback


@dataclass(frozen=True)
class CoulombFriction(Feedback):
    """f = e sign q̇ [Armstrong1994, Section 2]."""

    kind: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Coulomb friction"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Armstrong1994, Section 2]"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    on_displacement: ClassVar[bool] = False

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """sign q̇, its mean over each step of the time grid."""
        return sign(velocity)
