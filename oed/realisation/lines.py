"""A periodic signal as its lines: what is fixed by the design (the amplitudes) and what is free (the phases)."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.errors import MisuseError, RangeError, ShapeError


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines of a signal of period N, whose phases φ are free except at ω = 0 and at the Nyquist frequency.

        u(t) = Σ_k A_k cos(2π i_k t/N + φ_k),   t = 0 … N−1

    `indices` i (K,) are distinct and in 0..N/2, `amplitudes` A (K,) are positive, `free` (K,) marks the lines whose
    phase counts. The others are played with φ = 0: reversing the whole signal, or shifting it by a sample, brings
    every other choice of their signs back to this one without a change of |u|.
    """

    indices: IntArray
    amplitudes: FloatArray
    free: BoolArray
    samples: int

    @property
    def rms(self) -> float:
        """The root mean square of the signal on its own N samples, the same for all phases."""
        return float(np.sqrt(np.sum(np.where(self._alone, 1.0, 0.5) * self.amplitudes**2)))

    def signal(self, phases: FloatArray, samples: int | None = None) -> FloatArray:
        """u (..., M) on a grid of M equidistant samples of the period (default M = N), for phases (..., K)."""
        lines = self if samples is None else replace(self, samples=samples)
        spectrum = np.zeros((*phases.shape[:-1], lines.samples // 2 + 1), dtype=np.complex128)
        spectrum[..., lines.indices] = lines.samples * lines.half_amplitudes(phases)
        return np.asarray(fft.irfft(spectrum, lines.samples, axis=-1), dtype=np.float64)

    def half_amplitudes(self, phases: FloatArray) -> ComplexArray:
        """The coefficients (..., K) of exp(2πj i_k t/N): half an amplitude each, the whole where a line is alone."""
        weights = np.where(self._alone, 1.0, 0.5) * self.amplitudes
        return np.asarray(weights * np.exp(1j * np.where(self.free, phases, 0.0)), dtype=np.complex128)

    def largest(self, count: int) -> IntArray:
        """Positions in `indices` of the (at most) `count` free lines of largest amplitude, in order of frequency."""
        free = np.flatnonzero(self.free)
        order = np.argsort(-self.amplitudes[free], kind="stable")
        return np.sort(free[order[:count]])

    def shortened(self) -> "Lines":
        """The same lines on the shortest period that they all have in common (their indices divided by their gcd)."""
        divisor = int(np.gcd.reduce(np.append(self.indices, self.samples)))
        return replace(self, indices=self.indices // divisor, samples=self.samples // divisor)

    @property
    def _alone(self) -> BoolArray:
        return np.asarray((self.indices == 0) | (2 * self.indices == self.samples), dtype=np.bool_)


def designed_lines(indices: ArrayLike, energies: ArrayLike, samples: int) -> Lines:
    """The lines with the energies E_k = Σ_t u_k(t)² over one period of N samples.

        A_k = √(2 E_k/N),   and √(E_k/N) at i = 0 and i = N/2

    Lines without energy are left out. Raises ShapeError for arrays of different or wrong shape, and RangeError for a
    period below one sample, an index that is negative, repeated or above N/2, an energy that is negative or not
    finite, and when there is no energy at all.
    """
    index, energy = np.asarray(indices), np.asarray(energies, dtype=np.float64)
    _check(index, energy, samples)
    kept = energy > 0.0
    index, energy = index[kept].astype(np.int64), energy[kept]
    alone = (index == 0) | (2 * index == samples)
    return Lines(index, np.sqrt(np.where(alone, 1.0, 2.0) * energy / samples), ~alone, samples)


def signal_line_energies(signal: ArrayLike) -> FloatArray:
    """The energy of each DFT line of a signal of N samples, (N//2 + 1,), which together are Σ_t u(t)².

        E_i = 2|U_i|²/N,   |U_i|²/N at i = 0 and i = N/2,   U_i = Σ_t u(t) e^{−2πj i t/N}

    The unit is that of the signal, squared. Raises ShapeError unless the signal is one row of at least one sample.
    """
    u = np.asarray(signal, dtype=np.float64)
    if u.ndim != 1 or u.size == 0:
        raise ShapeError(f"signal: give one row of samples, not an array of shape {u.shape}", "signal")
    energies = 2.0 * np.abs(fft.rfft(u)) ** 2 / u.size
    energies[0] /= 2.0
    if u.size % 2 == 0:
        energies[-1] /= 2.0
    return np.asarray(energies, dtype=np.float64)


def _check(index: IntArray, energy: FloatArray, samples: int) -> None:
    if samples < 1:
        raise RangeError(f"samples: a period needs at least one sample, not {samples}", "samples")
    if index.ndim != 1 or energy.shape != index.shape:
        raise ShapeError(
            f"energies: give one energy for each line, not shape {energy.shape} for indices of shape {index.shape}",
            "energies",
        )
    if index.size and not np.issubdtype(index.dtype, np.integer):
        raise MisuseError("indices: lines are whole multiples of the frequency 1/period; give integers", "indices")
    _check_energies(energy)
    _check_indices(index, samples)


def _check_energies(energy: FloatArray) -> None:
    bad = np.flatnonzero(~(np.isfinite(energy) & (energy >= 0.0)))
    if bad.size:
        raise RangeError(f"energies: {energy[bad[0]]} at position {bad[0]} is not an energy (finite, ≥ 0)", "energies")
    if not np.any(energy > 0.0):
        raise RangeError("energies: there is no energy to play; give at least one line a positive energy", "energies")


def _check_indices(index: IntArray, samples: int) -> None:
    if len(np.unique(index)) != index.size:
        raise RangeError("indices: a line is given twice; add the energies of equal indices", "indices")
    if np.any(index < 0):
        raise RangeError(f"indices: {index.min()} is negative; lines are numbered from 0 (ω = 0)", "indices")
    if np.any(2 * index > samples):
        raise RangeError(
            f"indices: line {index.max()} lies above the Nyquist line {samples / 2:g} of {samples} samples;"
            f" play at least {2 * int(index.max())} samples a period",
            "indices",
        )
