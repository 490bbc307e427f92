"""Dry friction that is larger at low speed."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.friction import Friction
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class StribeckFriction(Friction):
    """f = e sign q̇ (1 + a e^{−(q̇/v)²}), a = `excess` at rest, v = `speed` of its decay [Armstrong1994, Section 2]."""

    kind: ClassVar[str] = "stribeck_friction"
    title: ClassVar[str] = "Stribeck friction"
    refines: ClassVar[str] = "coulomb_friction"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("excess", "number", (0.5,), highest=5.0),
        FurtherParameter("speed", "flow", (0.04, 0.15, 0.4), lowest=0.005, highest=1.0),
    )

    excess: float = 0.5
    speed: float = 1.0

    def size(self, velocity: FloatArray) -> FloatArray:
        """1 + a e^{−(q̇/v)²}."""
        return np.asarray(1 + self.excess * np.exp(-((velocity / self.speed) ** 2)))
