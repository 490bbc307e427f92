"""Chebyshev polynomials on the range of the scheduling variable."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from identification.arrays import FloatArray
from identification.errors import RangeError


@dataclass(frozen=True)
class Chebyshev:
    """Chebyshev polynomials, f_j(p) = cos(j arccos x) with x = (2p − p_max − p_min)/(p_max − p_min), j = 0 … degree.

    They span what the powers span and stay well conditioned for high degrees and for ranges far from zero.
    """

    kind: ClassVar[str] = "chebyshev"

    degree: Annotated[int, "highest polynomial degree"]

    def __post_init__(self) -> None:
        if self.degree < 0:
            raise RangeError(f"the degree is {self.degree}; it must be zero or more", "degree")

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.degree + 1

    def evaluate(self, p: FloatArray, minimum: float, maximum: float) -> FloatArray:
        """The functions at p (M,), as (M, size)."""
        x = (2 * p - maximum - minimum) / (maximum - minimum)
        return np.asarray(chebyshev.chebvander(x, self.degree), dtype=np.float64)

    @classmethod
    def example(cls) -> "Chebyshev":
        """A small one, for the conformance tests."""
        return cls(degree=3)
