"""Dry friction."""

from dataclasses import dataclass
from typing import ClassVar

from identification.places.friction import Friction


@dataclass(frozen=True)
class CoulombFriction(Friction):
    """f = e sign q̇ [Armstrong1994, Section 2]."""

    kind: ClassVar[str] = "coulomb_friction"
    title: ClassVar[str] = "Coulomb friction"
