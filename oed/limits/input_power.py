"""The root mean square of the input."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.models.model import Model
from oed.limits.limit import check_band, check_size, everywhere_or_at, within


@dataclass(frozen=True)
class InputPower:
    """The most power of the input, in a band or in all: √((1/2π) ∫ Φ dω) ≤ rms over the samples of an experiment."""

    kind: ClassVar[str] = "input_power"

    rms: Annotated[float, "root mean square of the input, in its unit"]
    minimum_rad_per_second: Annotated[float | None, "lower edge of the band, rad/s; null: open"] = None
    maximum_rad_per_second: Annotated[float | None, "upper edge of the band, rad/s; null: open"] = None
    operating_points: Annotated[tuple[tuple[float, ...], ...] | None, "where it holds; null: everywhere"] = None

    def __post_init__(self) -> None:
        check_size(self.rms, "rms")
        check_band(self.minimum_rad_per_second, self.maximum_rad_per_second)

    @property
    def words(self) -> str:
        """The limit in words."""
        return f"the input's root mean square of {self.rms:g}"

    def weights(self, model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
        """One in the band, (M, F)."""
        inside = within((self.minimum_rad_per_second, self.maximum_rad_per_second), omega)
        return np.tile(np.where(inside, 1.0, 0.0), (len(points), 1))

    def most(self, model: Model, points: FloatArray) -> FloatArray:
        """rms² (M,)."""
        return everywhere_or_at(self.rms**2, self.operating_points, model, points)

    @classmethod
    def example(cls, model: Model) -> "InputPower":
        """One unit, for the conformance tests."""
        return cls(1.0)
