"""Multisines: periodic signals with exactly the designed lines and a peak as low as phases allow."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError
from oed.realisation.descent import clipped, norm_descent, schroeder_phases
from oed.realisation.lines import Lines, designed_lines
from oed.realisation.minimax import polished

DRAWN = 1_000_000  # samples computed for random starts, at most
CLIPPED = 60_000  # samples kept in the starts that are clipped
DESCENDED = 20_000  # samples kept in the starts that are descended
MOST_BETWEEN = 2**24
BETWEEN = 16  # points a sample on which the peak between samples is judged, at least
FEW_LINES = 12  # up to this many free phases, random draws come close to the best, so they are polished as they are


def multisine(
    indices: ArrayLike,
    energies: ArrayLike,
    samples: int,
    generator: np.random.Generator | int,
    *,
    oversampling: int = 1,
) -> FloatArray:
    """One period u (N,) with the given energy in each line, nothing elsewhere, and phases of low crest factor.

        u(t) = Σ_k A_k cos(2π i_k t/N + φ_k),   Σ_t u(t)² = Σ_k E_k,   A_k = √(2E_k/N)  (√(E_k/N) at i = 0 and N/2)

    `indices` i (K,) number the DFT lines 0..N/2, `energies` E (K,) have the unit of u². Energies are met to the
    rounding of the samples (relative 1e-10 for lines above 1e-12 of the largest). The phases come from Schroeder's and
    random starts drawn with `generator` (the same state, the same signal), clipping [VanDerOuderaa1988], rising ℓ_p
    norms [Guillaume1991] and linear programmes on the peaks themselves.

    The peak that counts is that of the samples, which is what a zero-order hold plays. Behind a reconstruction filter
    the peak between samples may be higher: `oversampling` r > 1 minimises it on a grid of rN points instead.

    Raises ShapeError and RangeError as `designed_lines`, and RangeError for an oversampling below 1.
    """
    if oversampling < 1:
        raise RangeError(f"oversampling: {oversampling} is below 1, the samples themselves", "oversampling")
    lines = designed_lines(indices, energies, samples)
    fine = replace(lines, samples=samples * oversampling) if oversampling > 1 else lines
    return lines.signal(optimised_phases(fine, np.random.default_rng(generator)))


def crest_factor(signal: ArrayLike, oversampling: int = 1) -> float:
    """The crest factor of one period u (N,): its peak over its root mean square.

        CR = max_t |u(t)| / √((1/N) Σ_t u(t)²)

    With `oversampling` r > 1 the peak is taken on rN points of the band-limited interpolation of the period. Raises
    ShapeError unless there is one row of samples, RangeError when they are all zero or not finite.
    """
    u = np.asarray(signal, dtype=np.float64)
    if u.ndim != 1 or u.size == 0:
        raise ShapeError(f"signal: give one row of samples, not an array of shape {u.shape}", "signal")
    rms = float(np.sqrt(np.mean(u**2)))
    if not (np.isfinite(rms) and rms > 0.0):
        raise RangeError("signal: a crest factor needs finite samples that are not all zero", "signal")
    return float(np.abs(interpolated(u, oversampling)).max()) / rms


def peak_between_samples(signal: FloatArray, finer_than: int = 1) -> float:
    """What max |u| of the band-limited interpolation of one period (N,) does not exceed, within half a per cent of it.

        max_t |u(t)| ≤ max_i |u(t_i)| / cos(π/2r),   t_i on r points a sample                         [EhlichZeller1964]

    for trigonometric polynomials of degree N/2 at most. r is 16, and at least four times `finer_than`, the points a
    sample on which phases were chosen: between those the peaks are highest. For periods of more than 2²⁰ samples r is
    smaller, and what is said further above the peak.
    """
    grid = max(min(max(BETWEEN, 4 * finer_than), MOST_BETWEEN // len(signal)), 2 * finer_than, 4)
    return float(np.abs(interpolated(signal, grid)).max()) / float(np.cos(np.pi / (2 * grid)))


def interpolated(signal: FloatArray, oversampling: int) -> FloatArray:
    """The band-limited interpolation (rN,) of one period (N,); its samples at multiples of r are those given."""
    if oversampling == 1:
        return signal
    N = len(signal)
    spectrum = np.zeros(oversampling * N // 2 + 1, dtype=np.complex128)
    spectrum[: N // 2 + 1] = fft.rfft(signal)
    if N % 2 == 0:
        spectrum[N // 2] /= 2.0
    return np.asarray(oversampling * fft.irfft(spectrum, oversampling * N), dtype=np.float64)


def optimised_phases(lines: Lines, generator: np.random.Generator) -> FloatArray:
    """Phases (K,) with a low max|u| over the samples of `lines`; zeros when there is no free phase."""
    if not np.any(lines.free):
        return np.zeros(len(lines.indices))
    short = lines.shortened()
    grid = _descent_grid(short)
    drawn = _drawn(short, generator)
    started = np.vstack([schroeder_phases(short), drawn[: _share(CLIPPED, grid, 1, 32)]])
    kept = _lowest(short, clipped(short, started, grid), _share(DESCENDED, grid, 2, 8))
    found = np.array([norm_descent(short, phases, grid) for phases in kept])
    if np.count_nonzero(short.free) <= FEW_LINES:
        found = np.array([polished(short, phases, iterations=15) for phases in np.vstack([found, drawn[:8]])])
    finished = np.array([polished(short, phases) for phases in _lowest(short, found, 2)])
    return np.asarray(_lowest(short, finished, 1)[0], dtype=np.float64)


def _descent_grid(lines: Lines) -> int:
    """As many samples as show the shape of the signal, where its own are far more than that."""
    enough = int(fft.next_fast_len(16 * int(lines.indices.max()) + 64, real=True))
    return min(lines.samples, enough)


def _drawn(lines: Lines, generator: np.random.Generator) -> FloatArray:
    """Random phases, the lowest peak first."""
    draws = generator.uniform(0.0, 2.0 * np.pi, (_share(DRAWN, lines.samples, 8, 1000), len(lines.indices)))
    return _lowest(lines, draws, len(draws))


def _lowest(lines: Lines, phases: FloatArray, count: int) -> FloatArray:
    """The `count` rows of phases (S, K) with the lowest peak, the lowest first."""
    peaks = np.abs(lines.signal(phases)).max(axis=-1)
    return phases[np.argsort(peaks, kind="stable")[:count]]


def _share(budget: int, grid: int, least: int, most: int) -> int:
    return int(np.clip(budget // grid, least, most))
