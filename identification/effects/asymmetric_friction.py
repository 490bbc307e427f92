"""Dry friction that differs between the two directions."""

from dataclasses import dataclass
from typing import ClassVar, Self

from identification.comparison.batch import Batch
from identification.places.friction import Friction
from identification.places.place import FurtherParameter


@dataclass(frozen=True)
class AsymmetricFriction(Friction):
    """f = e (sign q̇ + a): e (1 + a) forwards and e (1 − a) backwards, a = `asymmetry` [Armstrong1994, Section 2].

    Its mean e a shows in the mean of the output alone; an acceleration has none.
    """

    kind: ClassVar[str] = "asymmetric_friction"
    title: ClassVar[str] = "asymmetric friction"
    refines: ClassVar[str] = "coulomb_friction"
    parameters: ClassVar[tuple[FurtherParameter, ...]] = (
        FurtherParameter("asymmetry", "number", (-0.5, 0.5), lowest=-1.0, highest=1.0),
    )

    asymmetry: float = 0.5

    @property
    def offset(self) -> float:
        """a."""
        return self.asymmetry

    def seen_by(self, batch: Batch) -> list[Self]:
        """As a force on the motion that the signals are, but where the mean of that does not show."""
        return [one for one in super().seen_by(batch) if one.order < 2]
