"""What every limit offers to the solver."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, FloatArray
from identification.errors import RangeError, ShapeError
from identification.models.model import Model
from oed.hypothesis import response_batch

SAME_POINT = 1e-9


class Limit(Protocol):
    """A bound on a mean square that is linear in the input spectrum; the plug-ins of `oed.limits`.

        (1/2π) ∫ w(p, ω) Φ(p, ω) dω ≤ c(p)     with Φ the mean square of the input by frequency

    Its multiplier ν adds ν w(p, ω) to what every frequency costs.
    """

    def weights(self, model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
        """w (M, F) at operating points (M, s) and ω (F,) in rad/s."""

    def most(self, model: Model, points: FloatArray) -> FloatArray:
        """c (M,), infinite where the limit does not hold; zero where w may not be excited at all."""

    @property
    def words(self) -> str:
        """The limit in words, for advice."""


def shares_of(limits: Sequence[Limit], model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
    """w/c (L, M, F), what a mean square of one takes of each limit; infinite where there must be nothing."""
    return np.stack([_share(model, limit, points, omega) for limit in limits])


def _share(model: Model, limit: Limit, points: FloatArray, omega: FloatArray) -> FloatArray:
    weights, most = limit.weights(model, points, omega), limit.most(model, points)[:, None]
    closed = (most == 0) & (weights > 0)
    return np.asarray(np.where(closed, np.inf, weights / np.where(most > 0, most, 1.0)))


def gain(model: Model, points: FloatArray, omega: FloatArray) -> FloatArray:
    """|G(p, ω)|² (M, F) of the model with its effects."""
    if model.effects:
        return np.asarray(abs(model.respond(response_batch(model, points, omega)).output) ** 2)
    return np.asarray(abs(model.frequency_response(points, omega)[..., 0, 0]) ** 2)


def within(band: tuple[float | None, float | None], omega: FloatArray) -> BoolArray:
    """Which ω (F,) lie between two ends, either of which may be open."""
    low, high = band
    above = omega >= (low or 0.0) * (1 - 1e-9)
    return np.asarray(above & (omega <= (np.inf if high is None else high) * (1 + 1e-9)))


def everywhere_or_at(
    value: float, where: Sequence[Sequence[float]] | None, model: Model, points: FloatArray
) -> FloatArray:
    """The value at the operating points named, or at all (None), and infinity elsewhere, (M,)."""
    if where is None:
        return np.full(len(points), value)
    spans = np.array([v.maximum - v.minimum for v in model.dependence.variables])
    result = np.full(len(points), np.inf)
    for row in where:
        if len(row) != len(spans):
            raise ShapeError(f"an operating point has {len(row)} values for {len(spans)} variables", "limits")
        same = np.all(abs(points - np.asarray(row)) <= SAME_POINT * spans, axis=1)
        if not same.any():
            raise RangeError(f"a limit holds at {list(row)}, which is none of the operating points", "limits")
        result[same] = value
    return result


def check_band(low: float | None, high: float | None) -> None:
    """Raises RangeError for ends of a band that are negative, not finite or do not rise."""
    if any(end is not None and not (np.isfinite(end) and end >= 0) for end in (low, high)):
        raise RangeError("the ends of a band must be zero or more", "minimum_rad_per_second")
    if low is not None and high is not None and low > high:
        raise RangeError("the band must rise", "maximum_rad_per_second")


def check_size(value: ArrayLike, field: str) -> None:
    """Raises RangeError for a limit that is not positive and finite."""
    if not (np.isfinite(value) and np.asarray(value) > 0):
        raise RangeError("a limit must be positive and finite", field)
