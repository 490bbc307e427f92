"""The root mean square of the output."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.models.model import Model
from oed.limits.limit import check_band, check_size, everywhere_or_at, gain, within


@dataclass(frozen=True)
class OutputPower:
    """The most that the input may move the output, in a band or in all: √((1/2π) ∫ |G(p, ω)|² Φ dω) ≤ rms.

    Of the noise-free output in its steady state, as the model has it; noise comes on top.
    """

    kind: ClassVar[str] = "output_power"

    rms: Annotated[float, "root mean square of the output, in its unit"]
    minimum_rad_per_second: Annotated[float | None, "lower edge of the band, rad/s; null: open"] = None
    maximum_rad_per_second: Annotated[float | None, "upper edge of the band, rad/s; null: open"] = None
    operating_points: Annotated[tuple[tuple[float, ...], ...] | None, "where it holds; null: everywhere"] = None

    def __post_init__(self) -> None:
        check_size(self.rms, "rms")
        check_band(self.minimum_rad_per_second, self.maximum_rad_per_second)

    @property
    def words(self) -> str:
        """The limit in words."""
        return f"the output's root mean square of {self.rms:g}"

    def weights(self, model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
        """|G|² in the band, (M, F)."""
        inside = within((self.minimum_rad_per_second, self.maximum_rad_per_second), omega)
        return np.asarray(np.where(inside, gain(model, points, omega), 0.0))

    def most(self, model: Model, points: FloatArray) -> FloatArray:
        """rms² (M,)."""
        return everywhere_or_at(self.rms**2, self.operating_points, model, points)

    @classmethod
    def example(cls, model: Model) -> "OutputPower":
        """One unit, for the conformance tests."""
        return cls(1.0)
