"""How a change inside the loop of a plant and its forces comes out: the loop linearised around a steady state."""

from functools import cached_property

import numpy as np

from identification.arrays import ComplexArray, FloatArray, IntArray
from identification.places.in_time import LinearisedInTime
from identification.places.krylov import gmres
from identification.places.loop import Loop
from identification.places.motion import displacement, flow_rate, powers
from identification.places.nonlinear import Feedback

REACTING, MOST_LINES = 0.05, 80
ACCURATE, PRODUCTS = 1e-3, 40


class Linearised:
    """The loop around a steady state: δX + G F{f_q δq + f_v δq̇} = δ, solved for δX.

    By a Krylov method on the products with it, preconditioned by the same loop with forces that act as impulses on the
    time grid (`LinearisedInTime`); where plants have no states the lines that react most are inverted together.
    """

    def __init__(self, loop: Loop, x: ComplexArray) -> None:
        self.loop = loop
        self.slopes = []
        self.motions: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for effect, e in loop.forces:
            motion = loop.motion(effect, x)
            by_q, by_flow = effect.slopes(*motion)
            self.slopes.append((effect, e * by_q, e * by_flow))
            self.motions.append((e, *motion))
        self.yielding = loop.yielding(x) if loop.order else np.ones(len(x))

    @cached_property
    def lines(self) -> IntArray:
        """Those that react most."""
        gain = np.zeros(self.loop.response.shape)
        for effect, by_q, by_flow in self.slopes:
            size = [np.sqrt(np.mean(part**2, axis=1, keepdims=True)) for part in (by_q, by_flow)]
            reach = size[0] * abs(powers(self.loop.batch, -effect.order))
            reach = reach + size[1] * abs(powers(self.loop.batch, 1 - effect.order))
            gain += abs(self.loop.response) * reach * abs(effect.rates(self.loop.batch))
        largest = gain.max(axis=0)
        chosen = np.flatnonzero(largest > REACTING)
        return np.asarray(chosen[np.argsort(-largest[chosen], kind="stable")[:MOST_LINES]])

    def applied(self, change: ComplexArray) -> ComplexArray:
        """The left side (M, K or K + 1) for a change of the unknowns."""
        total = np.zeros_like(self.loop.response)
        core, mean = self.loop.split(change)
        batch, finer = self.loop.batch, self.loop.finer
        for (effect, by_q, by_flow), (e, at_q, at_flow) in zip(self.slopes, self.motions, strict=True):
            q = batch.signal(displacement(core, mean, batch, effect.order), finer)
            flow = batch.signal(flow_rate(core, batch, effect.order), finer)
            force = by_q * q + by_flow * flow if effect.at_once else e * effect.changed(at_q, at_flow, q, flow)
            total += effect.rates(batch) * batch.spectrum(force)
        moved = core + self.loop.response * total
        if not self.loop.order:
            return moved
        row = (self.loop.stiffness * mean + total[:, 0].real) / self.yielding
        return np.concatenate([moved, row[:, None]], axis=1)

    def solve(self, wanted: ComplexArray, tolerance: float = ACCURATE) -> ComplexArray:
        """The change (M, K or K + 1) that a change `wanted` at the same places comes to in the closed loop."""
        return gmres(self.applied, self._nearly, wanted, tolerance, PRODUCTS)

    def _nearly(self, wanted: ComplexArray) -> ComplexArray:
        """The solution on the time grid; where plants have no states, as if only the lines that react did."""
        return self._on_lines(wanted) if self._in_time is None else self._over_time(wanted, self._in_time)

    @cached_property
    def _in_time(self) -> LinearisedInTime | None:
        plants = self.loop.plants
        if plants is None:
            return None
        by_q, by_flow = (np.sum(parts, axis=0) for parts in list(zip(*self.slopes, strict=True))[1:])
        return LinearisedInTime(plants, by_q, by_flow)

    @property
    def growth(self) -> FloatArray | None:
        """Of small changes over a period (M,); None where plants have no states."""
        return None if self._in_time is None else self._in_time.growth

    def _over_time(self, wanted: ComplexArray, in_time: LinearisedInTime) -> ComplexArray:
        """With the mean of the displacement as its own equation has it for the forces that are found."""
        batch, finer, effect = self.loop.batch, self.loop.finer, self.slopes[0][0]
        core, mean = self.loop.split(wanted)
        unyielding = np.zeros_like(in_time.by_flow)
        if np.any(in_time.by_displacement):
            unyielding += in_time.by_displacement * batch.signal(displacement(core, mean, batch, effect.order), finer)
        if np.any(in_time.by_flow):
            unyielding += in_time.by_flow * batch.signal(flow_rate(core, batch, effect.order), finer)
        force = in_time.force(unyielding)
        moved = core - self.loop.response * effect.rates(batch) * batch.spectrum(force)
        if not self.loop.order:
            return np.asarray(moved)
        own = 0.0 if effect.differentiated else in_time.by_displacement.mean(axis=1)
        seen = 0.0 if effect.differentiated else force.mean(axis=1)
        balance = self.loop.stiffness + own
        balanced = (self.yielding * mean - seen + own * mean) / np.where(abs(balance) > 0, balance, 1.0)
        return np.concatenate([moved, balanced[:, None]], axis=1)

    def _on_lines(self, wanted: ComplexArray) -> ComplexArray:
        result = wanted.copy()
        if not len(self.lines) and not self.loop.order:
            return result
        chosen = wanted[:, self.lines]
        parts = [chosen.real, chosen.imag]
        if self.loop.order:
            parts.append(wanted[:, -1:].real)
        solution = (self._inverse @ np.concatenate(parts, axis=1)[..., None])[..., 0]
        n = len(self.lines)
        result[:, self.lines] = solution[:, :n] + 1j * solution[:, n : 2 * n]
        if self.loop.order:
            result[:, -1] = solution[:, -1]
        return result

    @cached_property
    def _inverse(self) -> FloatArray:
        try:
            return np.asarray(np.linalg.inv(self._matrix), dtype=np.float64)
        except np.linalg.LinAlgError:
            return np.asarray(np.linalg.pinv(self._matrix), dtype=np.float64)

    @property
    def _matrix(self) -> FloatArray:
        """The left side on the lines that react as a real matrix (M, 2n [+ 1], 2n [+ 1])."""
        m, n, extra = len(self.loop.response), len(self.lines), int(self.loop.order > 0)
        matrix = np.zeros((m, 2 * n + extra, 2 * n + extra))
        matrix[:, np.arange(2 * n), np.arange(2 * n)] = 1.0
        if extra:
            matrix[:, -1, -1] = self.loop.stiffness / self.yielding
        gain = self.loop.response[:, self.lines]
        for effect, by_q, by_flow in self.slopes:
            self._add(matrix, gain, effect, by_q, -effect.order)
            self._add(matrix, gain, effect, by_flow, 1 - effect.order)
            if extra and effect.on_displacement and effect.order:
                self._add_mean(matrix, gain, effect, by_q)
        return matrix

    def _add(self, matrix: FloatArray, gain: ComplexArray, effect: Feedback, slope: FloatArray, exponent: int) -> None:
        """Σ_k c_{m−k} D_k X_k + c_{m+k} D_k* X_k*, c the lines of the slope, D = (jω)^exponent."""
        if not np.any(slope):
            return
        n, k = len(self.lines), self.lines
        c = np.fft.rfft(slope) / slope.shape[1]
        c = np.pad(c, ((0, 0), (0, max(2 * int(k.max(initial=0)) + 1 - c.shape[1], 0))))
        apart = k[:, None] - k[None, :]
        near = np.where(apart >= 0, c[:, abs(apart)], c[:, abs(apart)].conj())
        far = c[:, k[:, None] + k[None, :]] * (k[None, :] > 0)
        by = powers(self.loop.batch, exponent)[k]
        rate = effect.rates(self.loop.batch)[k][:, None]
        near, far = near * by * rate, far * by.conj() * rate
        self._insert(matrix[:, : 2 * n, : 2 * n], gain[..., None] * near, gain[..., None] * far)
        if self.loop.order and not effect.differentiated:
            first = c[:, k].conj() * by, c[:, k] * by.conj() * (k > 0)
            both, turned = first[0] + first[1], first[0] - first[1]
            row = np.concatenate([both.real, -turned.imag], axis=1)
            matrix[:, -1, : 2 * n] += row / self.yielding[:, None]

    @staticmethod
    def _insert(block: FloatArray, near: ComplexArray, far: ComplexArray) -> None:
        n = near.shape[-1]
        both, turned = near + far, near - far
        block[:, :n, :n] += both.real
        block[:, n:, :n] += both.imag
        block[:, :n, n:] -= turned.imag
        block[:, n:, n:] += turned.real

    def _add_mean(self, matrix: FloatArray, gain: ComplexArray, effect: Feedback, by_q: FloatArray) -> None:
        n, c = len(self.lines), np.fft.rfft(by_q) / by_q.shape[1]
        column = gain * c[:, self.lines] * effect.rates(self.loop.batch)[self.lines]
        matrix[:, :n, -1] += column.real
        matrix[:, n : 2 * n, -1] += column.imag
        matrix[:, -1, -1] += 0.0 if effect.differentiated else c[:, 0].real / self.yielding
