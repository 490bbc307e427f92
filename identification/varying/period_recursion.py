"""The steady state under periodic input and scheduling by recursion through one period: no growth with that of p(t)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import FloatArray
from identification.models.state_space import Matrices
from identification.varying.stacks import along

AT_ONCE = 100_000  # numbers of x(t): what stays in the cache, and no more memory than one state needs


@dataclass(frozen=True, eq=False)
class PeriodRecursion:
    """x(t) over one period of P samples for x(t+1) = F(t) x(t) + w(t), x(P) = x(0), F (P, n, n).

    The period is cut into √P parts that run side by side from rest, R(t), with their transitions Φ(t); the parts are
    joined, x at the end of a part being Φ x + R, and x(0) = (I − Ψ)⁻¹ c closes the period, Ψ the transition over it.
    Needs a spectral radius of Ψ below one; n³ P for Φ, n² P for each column of w.
    """

    transition: FloatArray

    @cached_property
    def _cut(self) -> tuple[int, int]:
        length = int(np.ceil(np.sqrt(len(self.transition))))
        return length, -(-len(self.transition) // length)

    def _parts(self, array: FloatArray, fill: FloatArray) -> FloatArray:
        """(P, n, ·) as (length, parts, n, ·), the end filled with what leaves x as it is."""
        length, parts = self._cut
        padded = np.concatenate([array, np.broadcast_to(fill, (length * parts - len(array), *fill.shape))])
        return np.ascontiguousarray(padded.reshape(parts, length, *array.shape[1:]).swapaxes(0, 1))

    @cached_property
    def _steps(self) -> FloatArray:
        return self._parts(self.transition, np.eye(self.transition.shape[1]))

    @cached_property
    def _transitions(self) -> FloatArray:
        """Φ before each sample of a part and at its end, (length + 1, parts, n, n)."""
        found = np.empty((len(self._steps) + 1, *self._steps.shape[1:]))
        found[0] = np.eye(found.shape[-1])
        for t, step in enumerate(self._steps):
            np.matmul(step, found[t], out=found[t + 1])
        return found

    def solve(self, forcing: FloatArray) -> FloatArray:
        """x (P, n, q) for w (P, n, q)."""
        drive = self._parts(forcing, np.zeros(forcing.shape[1:]))
        rest = np.zeros((len(drive) + 1, *drive.shape[1:]))
        for t, step in enumerate(self._steps):
            np.add(step @ rest[t], drive[t], out=rest[t + 1])
        starts, psi = np.zeros((drive.shape[1] + 1, *drive.shape[2:])), np.eye(self.transition.shape[1])
        for k, (phi, response) in enumerate(zip(self._transitions[-1], rest[-1], strict=True)):
            starts[k + 1], psi = phi @ starts[k] + response, phi @ psi
        first = np.linalg.solve(np.eye(len(psi)) - psi, starts[-1])
        for k, phi in enumerate(self._transitions[-1]):
            starts[k], first = first, phi @ first + rest[-1, k]
        found = self._transitions[:-1] @ starts[:-1] + rest[:-1]
        return np.asarray(found.swapaxes(0, 1).reshape(-1, *forcing.shape[1:])[: len(forcing)])


@dataclass(frozen=True, eq=False)
class PeriodicResponse:
    """The steady response over a period, and what it takes to differentiate it.

    `output` y (P, n_y); `signals` φ_i x and φ_i u (P, k, n + n_u); `c` C(p(t)), (P, n_y, n).
    """

    output: FloatArray
    signals: FloatArray
    c: FloatArray
    recursion: PeriodRecursion

    def through(self) -> FloatArray:
        """What each signal, added to each state, does to y: (P, n_y, n, k, n + n_u); some states at a time."""
        samples, n_y, n = self.c.shape
        flat = self.signals.reshape(samples, -1)
        at_once = max(1, AT_ONCE // (n * flat.size))
        found = np.empty((samples, n_y, n, flat.shape[1]))
        for first in range(0, n, at_once):
            states = np.arange(first, min(first + at_once, n))
            forcing = np.zeros((samples, n, len(states), flat.shape[1]))
            forcing[:, states, states - first] = flat[:, None]
            response = self.c @ self.recursion.solve(forcing.reshape(samples, n, -1))
            found[:, :, states] = response.reshape(samples, n_y, len(states), -1)
        return found.reshape(samples, n_y, n, *self.signals.shape[1:])


def periodic_response(matrices: Matrices, u: FloatArray, phi: FloatArray) -> PeriodicResponse:
    """Of the stacks A_i, B_i, C_i, D_i to one period of u (P, n_u) along φ (P, k)."""
    a, b, c, d = along(matrices, phi)
    recursion = PeriodRecursion(a)
    x = recursion.solve(b @ u[:, :, None])
    signals = phi[:, :, None] * np.concatenate([x[:, :, 0], u], axis=1)[:, None]
    return PeriodicResponse((c @ x + d @ u[:, :, None])[:, :, 0], signals, c, recursion)
