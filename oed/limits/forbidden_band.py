"""Frequencies that must not be excited."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.models.model import Model
from oed.limits.limit import check_band, everywhere_or_at, within


@dataclass(frozen=True)
class ForbiddenBand:
    """Frequencies that must not be excited at all, as around a resonance: Φ(p, ω) = 0 in the band.

    For line spectra and candidate multisines; an FIR spectrum is zero at single frequencies only, limit its power in
    the band instead.
    """

    kind: ClassVar[str] = "forbidden_band"

    minimum_rad_per_second: Annotated[float, "lower edge of the band, rad/s"]
    maximum_rad_per_second: Annotated[float, "upper edge of the band, rad/s"]
    operating_points: Annotated[tuple[tuple[float, ...], ...] | None, "where it holds; null: everywhere"] = None

    def __post_init__(self) -> None:
        check_band(self.minimum_rad_per_second, self.maximum_rad_per_second)

    @property
    def words(self) -> str:
        """The limit in words."""
        return f"the forbidden band from {self.minimum_rad_per_second:g} to {self.maximum_rad_per_second:g} rad/s"

    def weights(self, model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
        """One in the band, (M, F)."""
        inside = within((self.minimum_rad_per_second, self.maximum_rad_per_second), omega)
        return np.tile(np.where(inside, 1.0, 0.0), (len(points), 1))

    def most(self, model: Model, points: FloatArray) -> FloatArray:
        """Nothing, (M,)."""
        return everywhere_or_at(0.0, self.operating_points, model, points)

    @classmethod
    def example(cls, model: Model) -> "ForbiddenBand":
        """A narrow band, for the conformance tests."""
        return cls(0.3, 0.35)
