"""The steady state of a model under periodic input and scheduling, in small independent blocks of lines."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.models.state_space import Matrices
from identification.varying.period_recursion import periodic_response
from identification.varying.stacks import StackSizes


@dataclass(frozen=True, eq=False)
class HarmonicBlocks:
    """Spectra Y(θ) of the steady output over one period of P samples, and ∂Y/∂θ [Goos2014, (18), (19)].

        z_k X_k = Σ_i Σ_l μ_i[l] A_i X_{k − lP/T} + Σ_i B_i (φ_i u)_k,   Y_k = Σ_i Σ_l μ_i[l] C_i X_{k − lP/T} + …

    `input` (P, n_u) and `phi` φ (P, k) are one period, T = `scheduling_period` a divisor of P; μ_i is the
    discrete Fourier transform of φ_i over T samples, divided by T. Only lines r, r + P/T, r + 2P/T, … are
    coupled, so the equations fall into P/T blocks of T n_x unknowns; block −r is the conjugate of block r, and half of
    them are solved, all in one batch. That grows with T² n_x³ P; where T n_x is above `largest_block` and the model
    stable, the period is run through in time instead, which does not grow with T.
    """

    sizes: StackSizes
    input: FloatArray
    phi: FloatArray
    scheduling_period: int
    largest_block: int = 40

    @property
    def period(self) -> int:
        """P."""
        return len(self.input)

    @cached_property
    def block_lines(self) -> IntArray:
        """k = r + m P/T as (blocks, T), r = 0 … P/2T."""
        spacing = self.period // self.scheduling_period
        return np.arange(spacing // 2 + 1)[:, None] + spacing * np.arange(self.scheduling_period)

    @cached_property
    def _kept(self) -> BoolArray:
        """Of blocks that are their own conjugates, the lines up to P/2."""
        spacing = self.period // self.scheduling_period
        own = (2 * self.block_lines[:, :1]) % spacing == 0
        return np.asarray(~own | (2 * self.block_lines <= self.period))

    @cached_property
    def lines(self) -> IntArray:
        """The lines (F,) that Y and ∂Y/∂θ are given at: every k or its mirror image P − k, once."""
        return self.block_lines[self._kept]

    @cached_property
    def _circulants(self) -> ComplexArray:
        """(k, T, T): the convolution with μ_i."""
        steps = np.arange(self.scheduling_period)
        spectra = np.fft.fft(self.phi[: self.scheduling_period], axis=0).T / self.scheduling_period
        return np.asarray(spectra[:, (steps[:, None] - steps) % self.scheduling_period])

    @cached_property
    def extended_input(self) -> ComplexArray:
        """(P, k, n_u): the spectra of φ_i u, the extended input of the time-invariant start [Goos2014, (28)]."""
        return np.asarray(np.fft.fft(self.phi[:, :, None] * self.input[:, None, :], axis=0))

    @cached_property
    def _block_input(self) -> ComplexArray:
        return np.ascontiguousarray(self.extended_input[self.block_lines])

    @cached_property
    def _shifts(self) -> ComplexArray:
        return np.asarray(np.exp(2j * np.pi * self.block_lines / self.period))

    def stable(self, theta: FloatArray) -> bool:
        """Whether what an initial state leaves dies out: the spectral radius of A(T−1) … A(0) is below one."""
        product = np.tensordot(self.phi[: self.scheduling_period], self.sizes.split(theta)[0], 1)
        with np.errstate(over="ignore", invalid="ignore"):
            while len(product) > 1:
                even = 2 * (len(product) // 2)
                product = np.concatenate([product[1:even:2] @ product[:even:2], product[even:]])
        return bool(np.all(np.isfinite(product)) and abs(np.linalg.eigvals(product[0])).max() < 1)

    def _by_recursion(self, theta: FloatArray) -> bool:
        return self.scheduling_period * self.sizes.order > self.largest_block and self.stable(theta)

    def _coupled(self, stack: FloatArray) -> ComplexArray:
        """Σ_i μ_i ⊗ M_i as a matrix over (line, row) and (line, column)."""
        period, (_, rows, columns) = self.scheduling_period, stack.shape
        blocks = np.tensordot(self._circulants, stack, axes=(0, 0))
        return np.asarray(blocks.transpose(0, 2, 1, 3).reshape(period * rows, period * columns))

    def _resolvent(self, a: FloatArray) -> ComplexArray:
        """(zI − A)⁻¹ of every block, (blocks, T n_x, T n_x)."""
        size = self.scheduling_period * self.sizes.order
        matrices = np.repeat(-self._coupled(a)[None], len(self.block_lines), axis=0)
        diagonal = np.arange(size)
        matrices[:, diagonal, diagonal] += np.repeat(self._shifts, self.sizes.order, axis=1)
        return np.asarray(np.linalg.inv(matrices))

    def _states(self, resolvent: ComplexArray, b: FloatArray) -> ComplexArray:
        """X (blocks, T, n_x)."""
        blocks, period = self.block_lines.shape
        forcing = np.tensordot(self._block_input, b, axes=([2, 3], [0, 2])).reshape(blocks, -1, 1)
        return np.asarray((resolvent @ forcing).reshape(blocks, period, self.sizes.order))

    def output(self, theta: FloatArray) -> ComplexArray:
        """Y at `lines`, (F, n_y)."""
        a, b, c, d = self.sizes.split(theta)
        if self._by_recursion(theta):
            response = periodic_response((a, b, c, d), self.input, self.phi)
            return np.asarray(np.fft.fft(response.output, axis=0)[self.lines])
        blocks, period = self.block_lines.shape
        states = self._states(self._resolvent(a), b).reshape(blocks, -1, 1)
        through = np.tensordot(self._block_input, d, axes=([2, 3], [0, 2]))
        return np.asarray(((self._coupled(c) @ states).reshape(blocks, period, -1) + through)[self._kept])

    def output_and_jacobian(self, theta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Y (F, n_y) and ∂Y/∂θ (F, n_y, size).

        ∂Y/∂A_i[a, b] = Γ (zI − A)⁻¹ e_a (μ_i ∗ X)_b,   ∂Y/∂C_i[y, b] = e_y (μ_i ∗ X)_b,   φ_i u for B_i and D_i
        """
        n, n_y = self.sizes.order, self.sizes.n_outputs
        solved = self._recursion if self._by_recursion(theta) else self._blocks
        output, signals, through = solved(self.sizes.split(theta))
        outer = np.einsum("yw,fmj->fymwj", np.eye(n_y), signals)
        parts = (through[..., :n], through[..., n:], outer[..., :n], outer[..., n:])
        return output, np.concatenate([part.reshape(*part.shape[:2], -1) for part in parts], axis=2)

    def _blocks(self, matrices: Matrices) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Y, the spectra φ_i ∗ (X, U) (F, k, n + n_u), and Γ (zI − A)⁻¹ e_a of them (F, n_y, k, n, …)."""
        a, b, c, d = matrices
        blocks, period = self.block_lines.shape
        n, n_y, m = self.sizes.order, self.sizes.n_outputs, len(a)
        resolvent = self._resolvent(a)
        states = self._states(resolvent, b)
        scheduled = np.tensordot(states, self._circulants, axes=(1, 2)).transpose(0, 3, 2, 1)  # (blocks, T, k, n)
        signals = np.concatenate([scheduled, self._block_input], axis=3)
        output = np.tensordot(scheduled, c, axes=([2, 3], [0, 2])) + np.tensordot(
            self._block_input, d, axes=([2, 3], [0, 2])
        )
        through = (self._coupled(c) @ resolvent).reshape(blocks, period * n_y, period, n).transpose(0, 1, 3, 2)
        flat = through.reshape(blocks, period * n_y * n, period) @ signals.reshape(blocks, period, -1)
        inner = flat.reshape(blocks, period, n_y, n, m, -1)[self._kept].transpose(0, 1, 3, 2, 4)
        return np.asarray(output[self._kept]), signals[self._kept], inner

    def _recursion(self, matrices: Matrices) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """The same from the signals of a period."""
        response = periodic_response(matrices, self.input, self.phi)
        parts = response.output, response.signals, response.through().swapaxes(2, 3)
        mirrored = self.lines > self.period // 2
        spectra = [
            np.fft.rfft(part, axis=0)[np.where(mirrored, self.period - self.lines, self.lines)] for part in parts
        ]
        for spectrum in spectra:
            spectrum[mirrored] = spectrum[mirrored].conj()
        output, signals, through = spectra
        return output, signals, through
