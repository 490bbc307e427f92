"""Linear recursions with coefficients that vary over time, all steps side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import FloatArray

AT_ONCE = 32


@dataclass(frozen=True, eq=False)
class Recursion:
    """w_{k+1} = E_k w_k + g_k, w_N = w_0, for `steps` E (n, n, M, N), N a power of two, by cyclic reduction.

    Pairs of steps are one step of half as many, down to `AT_ONCE`, which are solved at once [Hockney1965].
    """

    steps: FloatArray

    @cached_property
    def _levels(self) -> list[FloatArray]:
        found = [self.steps]
        while found[-1].shape[-1] > AT_ONCE:
            found.append(_product(found[-1][..., 1::2], found[-1][..., ::2]))
        return found

    @cached_property
    def _closed(self) -> FloatArray:
        """All states from all that drives the steps of the last level, (M, n·r, n·r)."""
        n, _, m, r = self._levels[-1].shape
        steps = np.moveaxis(self._levels[-1], 2, 0)
        system = np.zeros((m, n, r, n, r))
        for k in range(r):
            system[:, :, (k + 1) % r, :, k] -= steps[..., k]
        system[:, np.arange(n)[:, None], np.arange(r), np.arange(n)[:, None], np.arange(r)] += 1.0
        flat = system.reshape(m, n * r, n * r)
        if not np.all(np.isfinite(flat)):
            return np.zeros_like(flat)
        inverse = _inverse(flat).reshape(m, n * r, n, r)
        return np.asarray(np.roll(inverse, -1, axis=-1).reshape(m, n * r, n * r))

    @property
    def whole(self) -> FloatArray:
        """E_{N−1} … E_0 (n, n, M)."""
        found = self._levels[-1]
        while found.shape[-1] > 1:
            found = _product(found[..., 1::2], found[..., ::2])
        return np.asarray(found[..., 0])

    def states(self, g: FloatArray) -> FloatArray:
        """w_0 … w_{N−1} (n, …, M, N) for g (n, …, M, N)."""
        levels = [g]
        for step in self._levels[:-1]:
            before, after = levels[-1][..., ::2], levels[-1][..., 1::2]
            levels.append(_applied(step[..., 1::2], before) + after)
        found = self._at_once(levels[-1])
        for step, driven in zip(self._levels[-2::-1], levels[-2::-1], strict=True):
            following = np.empty(driven.shape)
            following[..., ::2] = found
            following[..., 1::2] = _applied(step[..., ::2], found) + driven[..., ::2]
            found = following
        return found

    def _at_once(self, g: FloatArray) -> FloatArray:
        n, (m, r) = len(g), g.shape[-2:]
        flat = np.moveaxis(g, (-2, 0), (0, -2)).reshape(m, -1, n * r)
        found = flat @ np.swapaxes(self._closed, 1, 2)
        return np.asarray(np.moveaxis(found.reshape(m, *g.shape[1:-2], n, r), (0, -2), (-2, 0)))


def _inverse(system: FloatArray) -> FloatArray:
    try:
        return np.asarray(np.linalg.inv(system), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(system), dtype=np.float64)


def _applied(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    """Σ_j E_ij v_j for E (n, n, M, N) and v (n, …, M, N)."""
    found = np.empty(vectors.shape)
    for i, row in enumerate(matrices):
        np.multiply(row[0], vectors[0], out=found[i])
        for matrix, vector in zip(row[1:], vectors[1:], strict=True):
            found[i] += matrix * vector
    return found


def _product(left: FloatArray, right: FloatArray) -> FloatArray:
    """Σ_j E_ij F_jk for two (n, n, M, N)."""
    return np.stack([_applied(left, right[:, k]) for k in range(right.shape[1])], axis=1)
