"""Powers of the scheduling variable."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from identification.arrays import FloatArray
from identification.errors import RangeError


@dataclass(frozen=True)
class Polynomial:
    """Powers of the scheduling variable in its own unit, f_j(p) = p^j, j = 0 … degree [Ghosh2018, (2)]."""

    kind: ClassVar[str] = "polynomial"

    degree: Annotated[int, "highest power"]

    def __post_init__(self) -> None:
        if self.degree < 0:
            raise RangeError(f"the degree is {self.degree}; it must be zero or more", "degree")

    @property
    def size(self) -> int:
        """Number of functions."""
        return self.degree + 1

    def evaluate(self, p: FloatArray, minimum: float, maximum: float) -> FloatArray:
        """The functions at p (M,), as (M, size)."""
        return p[:, None] ** range(self.size)

    @classmethod
    def example(cls) -> "Polynomial":
        """A small one, for the conformance tests."""
        return cls(degree=2)
