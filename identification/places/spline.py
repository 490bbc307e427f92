"""Natural cubic splines whose shapes are ordered by their roughness."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from identification.arrays import FloatArray

FEWEST = 4
QUANTILE, BEYOND = 0.35, 0.1


@dataclass(frozen=True, eq=False)
class Spline:
    """n − 2 natural cubic splines φ_i over n knots, beyond all straight lines, equally rough.

        φ_i(κ_j) = V_ji λ_i^{−½},   K = V diag(0, 0, λ) Vᵀ,   aᵀ K a = ∫ f″² dx  for a curve with values a at the knots

    The columns of V are orthogonal to constants and straight lines at the knots, so that with coefficients of one
    variance a smooth curve is likelier than a rough one [GreenSilverman1994, Section 2.1]. x is measured in half the
    distance from the first to the last knot. Beyond them the curves are straight lines.
    """

    knots: FloatArray
    pieces: FloatArray

    @cached_property
    def height(self) -> float:
        """Root mean square of the smoothest φ at the knots."""
        at_knots = self(self.knots)
        return float(np.sqrt(np.mean(at_knots**2, axis=1)).max())

    @property
    def count(self) -> int:
        """n − 2."""
        return len(self.pieces)

    def __call__(self, x: FloatArray) -> FloatArray:
        """φ (n − 2, …) at x (…)."""
        return np.stack([self.combined(one, x) for one in np.eye(self.count)])

    def combined(self, coefficients: FloatArray, x: FloatArray, slope: bool = False) -> FloatArray:
        """Σ c_i φ_i (…) at x (…), or its `slope`, for c (n − 2,), or (n − 2, M) where x is (M, …)."""
        pieces = np.tensordot(coefficients, self.pieces, axes=([0], [0]))
        where = np.searchsorted(self.knots, x)
        start = np.concatenate([self.knots[:1], self.knots])[where]
        own = (np.arange(len(x)).reshape(-1, *(1,) * (x.ndim - 1)),) if pieces.ndim == 3 else ()
        c = pieces[(*own, where)]
        t = x - start
        if slope:
            return np.asarray(c[..., 1] + t * (2 * c[..., 2] + t * 3 * c[..., 3]))
        return np.asarray(c[..., 0] + t * (c[..., 1] + t * (c[..., 2] + t * c[..., 3])))


@lru_cache(maxsize=256)
def spline(knots: tuple[float, ...]) -> Spline:
    """The splines over these knots, four or more, in ascending order."""
    at = np.array(knots)
    half = (at[-1] - at[0]) / 2
    h = np.diff(at) / half
    n = len(at)
    q, r = np.zeros((n, n - 2)), np.zeros((n - 2, n - 2))
    for j in range(n - 2):
        q[j : j + 3, j] = 1 / h[j], -1 / h[j] - 1 / h[j + 1], 1 / h[j + 1]
        r[j, j] = (h[j] + h[j + 1]) / 3
        if j:
            r[j, j - 1] = r[j - 1, j] = h[j] / 6
    bending = np.linalg.solve(r, q.T)
    values, vectors = np.linalg.eigh(q @ bending)
    heights = vectors[:, 2:] / np.sqrt(values[2:])
    curvature = np.vstack([np.zeros(n - 2), bending @ heights, np.zeros(n - 2)]) / half**2
    return Spline(at, _pieces(np.diff(at), heights.T, curvature.T))


def _pieces(h: FloatArray, g: FloatArray, bent: FloatArray) -> FloatArray:
    """Coefficients (c, n + 1, 4) of powers of x from the left end of each piece, the outer ones straight."""
    found = np.zeros((len(g), len(h) + 2, 4))
    found[:, 1:-1, 0] = g[:, :-1]
    found[:, 1:-1, 1] = np.diff(g) / h - h * (2 * bent[:, :-1] + bent[:, 1:]) / 6
    found[:, 1:-1, 2] = bent[:, :-1] / 2
    found[:, 1:-1, 3] = np.diff(bent) / h / 6
    found[:, 0, 0], found[:, -1, 0] = g[:, 0], g[:, -1]
    found[:, 0, 1] = found[:, 1, 1]
    found[:, -1, 1] = found[:, -2, 1] + h[-1] * (2 * found[:, -2, 2] + h[-1] * 3 * found[:, -2, 3])
    return found


def spread_knots(values: FloatArray, most: int) -> tuple[float, ...]:
    """Up to `most` knots where the values are, and one beyond either end; none where they hardly differ.

    Between quantiles and even steps, so that rare values have knots as well, where strong forces are strongest; the
    outer ones, where curves run straight, leave them free to bend up to the last value.
    """
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return ()
    shares = np.linspace(0, 1, most)
    found = QUANTILE * np.quantile(values, shares) + (1 - QUANTILE) * (low + (high - low) * shares)
    apart = np.concatenate([[True], np.diff(found) > 1e-6 * (high - low)])
    kept = found[apart]
    outside = BEYOND * (high - low)
    return (low - outside, *map(float, kept), high + outside) if len(kept) >= FEWEST else ()
