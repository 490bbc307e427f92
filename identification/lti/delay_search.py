"""Delays that cannot be told apart, or hardly, by the frequencies that were measured."""

from functools import reduce

import numpy as np

from identification.arrays import ComplexArray, FloatArray

SAME, LONGEST = 1e-6, 100_000
AT_ONCE = 1 << 21
OFF_GRID = 1e-3
FINER = 64


def common_divisor(omega: FloatArray) -> float | None:
    """The largest ω₀ of which all frequencies (F,) are multiples, to a millionth of ω₀ each; None where there is none.

    By Euclid's algorithm on the frequencies themselves; a divisor more than 10⁵ times below the highest is no grid.
    """
    positive = np.sort(omega[omega > 0])
    if len(positive) == 0:
        return None
    smallest = positive[-1] / LONGEST

    def divisor(a: float, b: float) -> float:
        while b > smallest:
            a, b = b, a % b
            b = 0.0 if a - b < smallest else b
        return a

    found = float(reduce(divisor, positive.tolist()))
    counts = np.round(positive / max(found, smallest))
    found = float(positive @ counts / (counts @ counts))
    return found if np.all(abs(positive / found - counts) < OFF_GRID) else None


def aliases(omega: FloatArray) -> str:
    """Which other delays give the same response at the frequencies (F,), in words; empty where none do."""
    unit = common_divisor(omega)
    if unit is None:
        return ""
    turn = 2 * np.pi / unit
    text = f"all frequencies are multiples of {unit:.6g} rad/s, so a delay longer by {turn:.6g} s fits alike"
    if np.all(np.round(omega / unit) % 2 == 1):
        text += f", and one longer or shorter by {turn / 2:.6g} s with the opposite sign of the gain"
    return text


def shortest(tau: float, omega: FloatArray) -> float:
    """The shortest delay ≥ 0 with the same response at the frequencies (F,); just below 0 rather than just below 2π/ω₀.

    Where the frequencies have no common divisor ω₀, the delay itself.
    """
    unit = common_divisor(omega)
    if unit is None:
        return tau
    turn = 2 * np.pi / unit
    rest = float(tau % turn)
    return rest if turn - rest > np.pi / 4 / omega.max() else rest - turn


def refined_delays(omega: FloatArray, ratio: ComplexArray, coarse: FloatArray) -> FloatArray:
    """Next to each coarse delay the one with the largest Re Σ_k r_k e^{jω_k τ}, r_k = Y_k Ŷ_k* (F,)."""
    steps = np.diff(omega)
    reach, fine = np.pi / (4 * steps.max()), np.pi / (8 * omega[-1])
    near = np.arange(-reach, reach + fine, fine)[:LONGEST]
    found = []
    for tau in coarse:
        trial = tau + near
        block = max(AT_ONCE // len(omega), 1)
        parts = [trial[i : i + block] for i in range(0, len(trial), block)]
        values = np.concatenate([(np.exp(1j * np.outer(part, omega)) @ ratio).real for part in parts])
        found.append(trial[np.argmax(values)])
    return np.array(found)


def coherent_delays(omega: FloatArray, turns: ComplexArray, count: int = 3) -> FloatArray:
    """The delays τ (count,) at which a response is smoothest: largest Re Σ_k g_k e^{jτ Δω_k}, g_k = Ĝ_{k+1} Ĝ_k* Δω_k.

    `turns`: Ĝ_{k+1} Ĝ_k* (F − 1,). Searched from 0 to one turn over the smallest step, or 10⁵ grid points: at the
    longest delay looked for, the highest frequency has turned thousands of times. Memory does not grow with the grid.
    """
    steps = np.diff(omega)
    used = steps > SAME * omega[-1]
    steps, size = steps[used], abs(turns[used])
    weights = turns[used] / np.maximum(size, np.finfo(float).tiny) * steps
    if len(steps) == 0:
        return np.zeros(1)
    spacing = np.pi / (4 * steps.max())
    number = int(min(np.ceil(2 * np.pi / steps.min() / spacing), LONGEST))
    trial, values = spacing * np.arange(max(number, 1)), []
    block = max(AT_ONCE // len(steps), 1)
    for first in range(0, len(trial), block):
        values.append((np.exp(1j * np.outer(trial[first : first + block], steps)) @ weights).real)
    score = np.concatenate(values)
    padded = np.concatenate([[-np.inf], score, [-np.inf]])
    peaks = np.flatnonzero((padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:]))
    best = trial[peaks[np.argsort(-score[peaks], kind="stable")][:count]]
    near = best[:, None] + spacing * np.linspace(-1, 1, 2 * FINER + 1)
    finer = (np.exp(1j * near[..., None] * steps) @ weights).real
    return np.asarray(np.maximum(near[np.arange(len(near)), finer.argmax(axis=1)], 0.0))
