"""Dry friction that differs between the two directions."""

from dataclasses import dataclass
from typing import ClassVar, Self

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.friction import sign
from identification.places.nonlinear import Feedback
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class AsymmetricFriction(Feedback):
    """f = e (sign q̇ + a): e (1 + a) forwards and e (1 − a) backwards, a = `asymmetry` [Armstrong1994, Section 2].

    Its mean e a shows in the mean of the output alone; an acceleration has none.
    """

    kind: ClassVar[str] = "asymmetric_friction"
    title: ClassVar[str] = "asymmetric friction"
    domain: ClassVar[str] = "mechanical"
    unit: ClassVar[str] = "input unit"
    source: ClassVar[str] = "[Armstrong1994, Section 2]"
    refines: ClassVar[str] = "coulomb_friction"
    oversampling: ClassVar[int] = 8
    sign: ClassVar[int] = 1
    on_displacement: ClassVar[bool] = False
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("asymmetry", "number", (-0.5, 0.5), lowest=-1.0, highest=1.0),
    )

    asymmetry: float = 0.5

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """sign q̇ + a."""
        return sign(velocity) + self.asymmetry

    def seen_by(self, batch: Batch) -> list[Self]:
        """As a force on the motion that the signals are, but where the mean of that does not show."""
        return [one for one in super().seen_by(batch) if one.order < 2]
