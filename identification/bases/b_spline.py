"""B-splines with uniform or chosen interior knots."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError


@dataclass(frozen=True)
class BSpline:
    """B-splines of a degree with clamped ends, a partition of unity on [p_min, p_max].

    f_j is the j-th B-spline on the knots p_min (degree + 1 times), the interior knots, p_max (degree + 1 times);
    size = degree + 1 + number of interior knots. Not unisolvent: operating points must lie under every spline.
    """

    kind: ClassVar[str] = "b_spline"

    degree: Annotated[int, "polynomial degree of the pieces"]
    interior_knots: Annotated[tuple[float, ...], "places where the pieces meet, inside the range, in its unit"] = ()

    def __post_init__(self) -> None:
        if self.degree < 0:
            raise RangeError(f"the degree is {self.degree}; it must be zero or more", "degree")
        if np.any(np.diff(self.interior_knots) <= 0):
            raise RangeError("the interior knots must rise strictly", "interior_knots")

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.degree + 1 + len(self.interior_knots)

    def evaluate(self, p: FloatArray, minimum: float, maximum: float) -> FloatArray:
        """The functions at p (M,), as (M, size); raises RangeError when a knot lies outside (minimum, maximum)."""
        from scipy.interpolate import BSpline as Spline

        knots = np.array(self.interior_knots, dtype=float)
        if len(knots) and not (knots[0] > minimum and knots[-1] < maximum):
            raise RangeError(f"the interior knots must lie inside ({minimum}, {maximum})", "interior_knots")
        if len(p) == 0:
            return np.zeros((0, self.size))
        ends = self.degree + 1
        full = np.concatenate([np.full(ends, minimum), knots, np.full(ends, maximum)])
        design = Spline.design_matrix(np.clip(p, minimum, maximum), full, self.degree)
        return np.asarray(design.toarray(), dtype=np.float64)

    @classmethod
    def example(cls) -> "BSpline":
        """A small one, for the conformance tests."""
        return cls(degree=3)
