"""Half-planes left or right of a vertical line."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError
from identification.pole_regions.inequality import PoleRegion, require_finite

Side = Literal["left", "right"]


@dataclass(frozen=True)
class HalfPlane(PoleRegion):
    """Re z < a (left) or Re z > a (right); Re s < −a in continuous time bounds the slowest decay.

    f(z) = ± (z + z̄ − 2a), with + for the left side
    """

    kind: ClassVar[str] = "half_plane"

    edge: Annotated[float, "real part a of the edge"] = 0.0
    side: Annotated[Side, "which side of the edge"] = "left"

    def __post_init__(self) -> None:
        require_finite(self.edge, "edge")
        require_side(self.side)

    @property
    def matrices(self) -> tuple[FloatArray, FloatArray]:
        """P and Q, both (1, 1)."""
        sign = side_sign(self.side)
        return np.array([[-2.0 * sign * self.edge]]), np.array([[sign]])

    @property
    def real_interval(self) -> tuple[float, float]:
        """(−∞, a) or (a, ∞)."""
        return (-np.inf, self.edge) if self.side == "left" else (self.edge, np.inf)

    @classmethod
    def example(cls) -> "HalfPlane":
        """The stable poles in continuous time."""
        return cls()


def require_side(side: str) -> None:
    """Raises RangeError for a side that is neither left nor right."""
    if side not in ("left", "right"):
        raise RangeError(f"the side is {side!r}; it must be 'left' or 'right'", "side")


def side_sign(side: Side) -> float:
    """1 for the left side, −1 for the right."""
    return 1.0 if side == "left" else -1.0
