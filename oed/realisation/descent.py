"""Smooth descent on the peak of a multisine: many starts by clipping at once, then ℓ_p norms with rising p."""

import numpy as np
from scipy import fft
from scipy.optimize import minimize

from identification.arrays import FloatArray
from oed.realisation.lines import Lines


def schroeder_phases(lines: Lines) -> FloatArray:
    """The phases (K,) of a sweep that dwells at each frequency as long as its power asks [Schroeder1970].

    φ_k = −2π Σ_{l ≤ k} (i_l − i_{l−1}) Σ_{m < l} P_m,   P_m = power of line m as a share of the whole
    """
    order = np.argsort(lines.indices)
    power = lines.amplitudes[order] ** 2 / np.sum(lines.amplitudes**2)
    elapsed = np.cumsum(power) - power
    phases = np.empty(len(order))
    phases[order] = -2.0 * np.pi * np.cumsum(np.diff(lines.indices[order], prepend=0) * elapsed)
    return np.mod(phases, 2.0 * np.pi)


def clipped(lines: Lines, phases: FloatArray, grid: int, iterations: int = 150) -> FloatArray:
    """For each start phases (S, K) the best ones that clipping came across [VanDerOuderaa1988].

    A signal is clipped at a share of its peak that rises from a half to nine tenths, the phases of its lines are kept
    and their amplitudes restored, again and again. `grid` is the number of samples of the period that are looked at.
    """
    best, lowest = phases, np.full(len(phases), np.inf)
    for level in np.linspace(0.5, 0.9, iterations):
        signal = lines.signal(phases, grid)
        peak = np.abs(signal).max(axis=-1)
        better = peak < lowest
        best, lowest = np.where(better[:, np.newaxis], phases, best), np.where(better, peak, lowest)
        limit = level * peak[:, np.newaxis]
        spectrum = fft.rfft(np.clip(signal, -limit, limit), axis=-1)
        phases = np.angle(spectrum[:, lines.indices])
    return np.asarray(best, dtype=np.float64)


def norm_descent(lines: Lines, phases: FloatArray, grid: int, iterations: int = 60) -> FloatArray:
    """Phases (K,) that minimise ‖u‖_p for p = 4, 8, …, 512 in turn, each from the last [Guillaume1991].

    ‖u‖_p tends to max|u| as p grows. Each norm is descended with L-BFGS, on the logarithm and an exact gradient by FFT.
    """
    for exponent in range(2, 10):
        found = minimize(
            log_norm,
            phases,
            args=(lines, 2**exponent, grid),
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": iterations, "maxcor": 20, "gtol": 1e-9, "ftol": 1e-10},
        )
        phases = np.asarray(found.x, dtype=np.float64)
    return phases


def log_norm(phases: FloatArray, lines: Lines, p: int, grid: int) -> tuple[float, FloatArray]:
    """The logarithm of the ℓ_p norm on a grid of M samples and its gradient (K,) with respect to the phases.

        f(φ) = log max|u| + (1/p) log (1/M) Σ_t |u(t)/max|u||^p,   p a power of two

    ∂f/∂φ_k = Re(j a_k G_k*) / Σ_t u^p with G the DFT of u^{p−1} and a_k the amplitude of line k with its phase.
    """
    signal = lines.signal(phases, grid)
    peak = float(np.abs(signal).max())
    scaled = signal / peak
    power = scaled.copy()
    factor = scaled * scaled
    for _ in range(p.bit_length() - 2):
        power *= factor
        factor *= factor
    total = float(np.sum(factor))
    transform = fft.rfft(power)[lines.indices]
    amplitudes = lines.amplitudes * np.exp(1j * phases)
    gradient = np.real(1j * amplitudes * np.conj(transform)) / (peak * total)
    return np.log(peak) + np.log(total / grid) / p, np.where(lines.free, gradient, 0.0)
