"""What several regions have in common."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from scipy.linalg import block_diag

from identification.arrays import FloatArray
from identification.errors import ShapeError
from identification.pole_regions.disc import Disc
from identification.pole_regions.half_plane import HalfPlane
from identification.pole_regions.inequality import PoleRegion


@dataclass(frozen=True)
class Intersection(PoleRegion):
    """The points in all of several regions: f(z) = diag(f₁(z), f₂(z), …).

    Raises RangeError when nothing is left.
    """

    kind: ClassVar[str] = "intersection"

    regions: Annotated[tuple[PoleRegion, ...], "the regions, all of which must hold the poles"]

    def __post_init__(self) -> None:
        if not self.regions:
            raise ShapeError("an intersection of no regions was given; give one region or more", "regions")
        self.require_points()

    @property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, block diagonal, (r, r) with r the sum of the parts'."""
        parts = [region.matrices for region in self.regions]
        return block_diag(*(p for p, _ in parts)), block_diag(*(q for _, q in parts))

    @property
    def real_interval(self) -> tuple[float, float]:
        """The greatest lower and the least upper end of the parts."""
        ends = [region.real_interval for region in self.regions]
        return max(lower for lower, _ in ends), min(upper for _, upper in ends)

    @classmethod
    def example(cls) -> "Intersection":
        """The right half of the unit disc."""
        return cls((Disc(), HalfPlane(0.0, "right")))
