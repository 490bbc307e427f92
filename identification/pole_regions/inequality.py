"""A region of the complex plane as a linear matrix inequality."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, FloatArray
from identification.errors import RangeError


@dataclass(frozen=True)
class PoleRegion(ABC):
    """The open, convex region 𝒟 = {z : f(z) ≺ 0}, symmetric about the real axis.

        f(z) = P + Q z + Qᵀ z̄,   P = Pᵀ: r × r,   Q: r × r            [Kergus2019, (17); Chilali1999]

    All eigenvalues of A lie in 𝒟 if and only if some X ≻ 0 gives P ⊗ X + Q ⊗ (A X) + Qᵀ ⊗ (A X)ᵀ ≺ 0. The plane is
    that of z for models in discrete time and that of s in rad/s for models in continuous time.
    """

    @property
    @abstractmethod
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, both (r, r)."""

    @property
    @abstractmethod
    def real_interval(self) -> tuple[float, float]:
        """Where the region meets the real axis, lower and upper end; the lower is not below the upper when empty."""

    def excess(self, z: ArrayLike) -> FloatArray:
        """The largest eigenvalue of f(z), in the shape of z: negative inside, zero on the edge, positive outside.

        For a disc it is |z − centre| − radius; in general it grows with the distance from the region.
        """
        points = np.asarray(z, dtype=np.complex128)
        p, q = self.matrices
        values = p + points[..., None, None] * q + points.conj()[..., None, None] * q.T
        return np.asarray(np.linalg.eigvalsh(values)[..., -1], dtype=np.float64)

    def contains(self, z: ArrayLike) -> BoolArray:
        """Whether the points z lie in the open region, in the shape of z."""
        return np.asarray(self.excess(z) < 0)

    @property
    def empty(self) -> bool:
        """Whether no point lies in the region (a convex region symmetric about the real axis meets it unless empty)."""
        lower, upper = self.real_interval
        return not lower < upper

    @property
    def depth(self) -> float:
        """−min f(x) over the real axis: how far inside the deepest point lies; infinite for unbounded regions."""
        from scipy.optimize import minimize_scalar

        lower, upper = self.real_interval
        if not np.isfinite(upper - lower):
            return np.inf
        found = minimize_scalar(lambda x: float(self.excess(x)), bounds=(lower, upper), method="bounded")
        return -float(found.fun)

    def require_points(self) -> None:
        """Raises RangeError when the region is empty, with the numbers that leave nothing."""
        if self.empty:
            lower, upper = self.real_interval
            raise RangeError(
                f"the pole region is empty: on the real axis it asks for values above {lower:g} and below {upper:g};"
                " enlarge its parts until they meet",
                "region",
            )


def require_finite(value: float, field: str, positive: bool = False) -> None:
    """Raises RangeError unless the value is a finite number (above zero when `positive`)."""
    if not np.isfinite(value) or (positive and value <= 0):
        wanted = "a positive number" if positive else "a finite number"
        raise RangeError(f"{field} is {value}; give {wanted}", field)
