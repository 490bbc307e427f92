"""Rational functions on the lines of a frequency response: orthonormal bases, poles, and scales that lose no digits."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError
from identification.models.hold import without_hold
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse


@dataclass(frozen=True, eq=False)
class LinearProblem:
    """What the linear starts need of a frequency response: abscissae, weighted response, well-scaled structure.

    `x` (F,): jω/ω₀ in continuous time, q = e^{−jωT} in discrete time; `weights` (F,) > 0; ω₀ is the frequency scale of
    `structure`.
    """

    structure: RationalStructure
    omega: FloatArray
    response: ComplexArray
    weights: FloatArray

    @classmethod
    def of(cls, structure: RationalStructure, data: FrequencyResponse, weights: FloatArray) -> Self:
        """The problem of a measurement, its hold divided out; lines that differ only in order give the same problem."""
        order = np.argsort(data.frequencies)
        return cls(structure, data.frequencies[order], without_hold(data)[order], weights[order])

    @property
    def x(self) -> ComplexArray:
        """The variable of the polynomials on the lines, (F,)."""
        if self.structure.sample_time is None:
            return np.asarray(1j * self.omega / self.structure.frequency_scale)
        return np.asarray(np.exp(-1j * self.omega * self.structure.sample_time))

    def advanced(self, tau: FloatArray) -> ComplexArray:
        """The response without the delays τ (K,) and without q^{n_k}, as (K, F)."""
        known = np.exp(1j * self.omega * tau[:, None])
        return np.asarray(self.response * known / (self.x**self.structure.n_k if self.structure.n_k else 1.0))


def frequency_scale(structure: RationalStructure, data: FrequencyResponse) -> float:
    """An ω₀ in rad/s amid the measured band: the structure's own scale times a power of two, so that changing between
    them is exact; the structure's own in discrete time."""
    positive = data.frequencies[data.frequencies > 0]
    if structure.is_discrete or len(positive) == 0:
        return structure.frequency_scale
    middle = np.exp(np.mean(np.log([positive.min(), positive.max()])))
    return float(structure.frequency_scale * 2.0 ** np.round(np.log2(middle / structure.frequency_scale)))


def rescale(scaled: RationalStructure, target: float) -> FloatArray:
    """The factors (n,) that turn ζ of a continuous-time structure into ζ for the frequency scale `target`.

    a_i ← a_i ρ^i,   b_j ← b_j ρ^{n_a − n_b + j},   ρ = ω₀/target;   τ stays
    """
    if scaled.is_discrete:
        return np.ones(scaled.size)
    a, b = np.arange(1, scaled.n_a + 1), scaled.n_a - scaled.n_b + np.arange(scaled.n_b + 1)
    factors = (scaled.frequency_scale / target) ** np.concatenate([a, b, np.zeros(int(scaled.delay))]).astype(float)
    if not (np.all(np.isfinite(factors)) and np.all(factors > 0)):
        raise RangeError(
            "the coefficients would leave the range of numbers; choose a frequency scale inside the measured band",
            "frequency_scale",
        )
    return factors


def orthonormal(problem: LinearProblem, magnitude: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Polynomials of growing degree times w/|A_prev|, |A_prev| (K, F), orthonormal in Re Σ_k φ*ψ.

    Returns their values (K, F, m) and ascending coefficients (K, m, m), m = max(n_a, n_b) + 1.
    """
    m = max(problem.structure.n_a, problem.structure.n_b) + 1
    values = np.zeros((*magnitude.shape, m), dtype=np.complex128)
    coefficients = np.zeros((len(magnitude), m, m))
    vector, powers = np.asarray((problem.weights / magnitude)[..., None] + 0j), np.eye(m)[None, :, :1]
    for j in range(m):
        for _ in range(2 if j else 0):
            overlap = inner(values[..., :j], vector)
            vector = vector - values[..., :j] @ overlap
            powers = powers - coefficients[..., :j] @ overlap
        length = np.linalg.norm(vector, axis=1, keepdims=True)
        values[..., j : j + 1], coefficients[..., j : j + 1] = vector / length, powers / length
        vector = problem.x[:, None] * values[..., j : j + 1]
        powers = np.roll(coefficients[..., j : j + 1], 1, axis=1)
    return values, coefficients


def inner(left: ComplexArray, right: ComplexArray) -> FloatArray:
    """Re leftᴴ right over the lines: (K, F, i), (K, F, j) → (K, i, j)."""
    return np.asarray(np.swapaxes(left.real, 1, 2) @ right.real + np.swapaxes(left.imag, 1, 2) @ right.imag)


def as_zeta(structure: RationalStructure, a: FloatArray, b: FloatArray, tau: FloatArray) -> FloatArray:
    """ζ (K, n) from ascending coefficients; not finite where the leading coefficient of A vanishes."""
    lead = a[:, :1] if structure.is_discrete else a[:, -1:]
    with np.errstate(all="ignore"):
        a, b = a / lead, b / lead
    if not structure.is_discrete:
        a, b = a[:, ::-1], b[:, ::-1]
    return np.concatenate([a[:, 1:], b, *([tau[:, None]] if structure.delay else [])], axis=1)


def stabilised(structure: RationalStructure, a: FloatArray) -> FloatArray:
    """Ascending coefficients (K, n_a + 1) with unstable roots reflected, which leaves |A| on the lines as it was."""
    plain = RationalStructure(structure.n_a, 0, sample_time=structure.sample_time)
    zeta = as_zeta(plain, a, np.ones((len(a), 1)), np.zeros(len(a)))
    usable = np.all(np.isfinite(zeta), axis=-1)
    wrong = np.flatnonzero(usable & ~plain.stable(np.where(usable[:, None], zeta, 0.0)))
    if len(wrong) == 0:
        return a
    poles = plain.poles(zeta[wrong])
    if structure.is_discrete:
        outside = abs(poles) >= 1
        poles = np.where(outside, np.minimum(1 / np.maximum(abs(poles), 1e-300), 1 - 1e-9) * _direction(poles), poles)
    else:
        floor = 1e-9 * np.maximum(abs(poles), 1e-12 * abs(poles).max(axis=-1, keepdims=True) + 1e-300)
        poles = -np.maximum(abs(poles.real), floor) + 1j * poles.imag
    result = a.copy()
    result[wrong] = _expanded(structure, poles)
    return result


def _direction(z: ComplexArray) -> ComplexArray:
    return np.asarray(np.exp(1j * np.angle(z)))


def _expanded(structure: RationalStructure, poles: ComplexArray) -> FloatArray:
    """Ascending coefficients (K, n + 1) of Π(x − p_i), in discrete time Π(1 − p_i q); p (K, n) in conjugate pairs."""
    descending = np.ones((len(poles), 1), dtype=np.complex128)
    for i in range(poles.shape[1]):
        longer = np.pad(descending, ((0, 0), (0, 1)))
        longer[:, 1:] -= poles[:, i : i + 1] * descending
        descending = longer
    return np.asarray(descending.real if structure.is_discrete else descending.real[:, ::-1])


def from_poles(problem: LinearProblem, poles: ComplexArray) -> ComplexArray:
    """Π over the poles (K, n) on the lines, as (K, F)."""
    if problem.structure.is_discrete:
        return np.asarray(np.prod(1 - poles[..., None] * problem.x, axis=1))
    return np.asarray(np.prod(problem.x - poles[..., None], axis=1))


def mapped(problem: LinearProblem, poles: ComplexArray) -> ComplexArray:
    """Poles in rad/s as roots in the variable of the structure."""
    if problem.structure.sample_time is not None:
        return np.exp(poles * problem.structure.sample_time)
    return poles / problem.structure.frequency_scale
