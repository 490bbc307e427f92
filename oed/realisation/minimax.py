"""The last digits of a crest factor: the peak itself is minimised, by linear programmes on the samples near it."""

import numpy as np
from scipy.optimize import linprog

from identification.arrays import FloatArray, IntArray
from oed.realisation.lines import Lines


def polished(lines: Lines, phases: FloatArray, largest: int = 64, iterations: int = 60) -> FloatArray:
    """Phases (K,) at a local minimum of max_t |u(t)|, from phases that may be near it.

        min τ   s.t.  |u(t)| + Σ_k ∂|u(t)|/∂φ_k δ_k ≤ τ near the peak,   |δ_k| ≤ min(1, d √(max A/A_k))

    Where |u(t)| is large it bends down in the phases, so minima tend to be corners at which peaks of equal height
    meet, and the sequence of linear programmes ends there quadratically. The trust region d lets weak lines turn
    further, by which all lines bend alike. Only the `largest` lines move.
    """
    moving = lines.largest(largest)
    signal = lines.signal(phases)
    peak = float(np.abs(signal).max())
    radius = 0.1
    for _ in range(iterations):
        step, gain = _linear_step(lines, phases, signal, moving, radius)
        if gain <= 1e-15 * peak:
            break
        trial = phases.copy()
        trial[moving] += step
        trial_signal = lines.signal(trial)
        trial_peak = float(np.abs(trial_signal).max())
        ratio = (peak - trial_peak) / gain
        if trial_peak < peak:
            phases, signal, peak = trial, trial_signal, trial_peak
        radius = _next_radius(radius, ratio)
        if radius < 1e-14:
            break
    return phases


def _linear_step(
    lines: Lines, phases: FloatArray, signal: FloatArray, moving: IntArray, radius: float
) -> tuple[FloatArray, float]:
    height, amplitudes = np.abs(signal), lines.amplitudes[moving]
    peak = height.max()
    reach = np.minimum(1.0, radius * np.sqrt(amplitudes.max() / amplitudes))
    active = _near_peak(height, 2.0 * float(amplitudes @ reach), 6 * len(moving) + 50)
    turns = np.outer(active, lines.indices[moving]) % lines.samples / lines.samples
    slopes = -np.sign(signal[active])[:, np.newaxis] * amplitudes * np.sin(2.0 * np.pi * turns + phases[moving])
    changes = slopes * reach
    scale = float(np.abs(changes).max())
    if scale == 0.0:
        return np.zeros(len(moving)), 0.0
    found = linprog(
        np.append(np.zeros(len(moving)), 1.0),
        A_ub=np.hstack([changes / scale, -np.ones((len(active), 1))]),
        b_ub=(peak - height[active]) / scale,
        bounds=[(-1.0, 1.0)] * len(moving) + [(None, None)],
        method="highs-ds",
    )
    if found.x is None:
        return np.zeros(len(moving)), 0.0
    return reach * np.asarray(found.x[:-1], dtype=np.float64), -scale * float(found.x[-1])


def _near_peak(height: FloatArray, reach: float, most: int) -> IntArray:
    near = np.flatnonzero(height >= height.max() - reach)
    if len(near) > most:
        near = np.sort(near[np.argsort(-height[near], kind="stable")[:most]])
    return near


def _next_radius(radius: float, ratio: float) -> float:
    if ratio < 0.25:
        return radius / 4.0
    return min(2.0 * radius, 0.5) if ratio > 0.75 else radius
