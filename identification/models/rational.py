"""Rational models of the Box–Jenkins family at one operating point."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from identification.arrays import ComplexArray, FloatArray, require_positive
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.hold import held_ratio, held_ratio_gradient
from identification.models.recursion import propagate
from identification.models.structure import NOT_ALONG, Along, DifferenceEquation, Group, Structure
from identification.signals import HeldInput


@dataclass(frozen=True)
class RationalStructure(Structure):
    """Orders of y = G u + H e with G = B/A and H = C/D, all four polynomials parametrised independently.

    Discrete time (`sample_time` T in seconds), q = e^{−jωT} [Ghosh2018, (1), (4)]:

        A = 1 + Σ a_i q^i,  B = q^{n_k} Σ b_i q^i,  C = 1 + Σ c_i q^i,  D = 1 + Σ d_i q^i

    Continuous time (`sample_time` None), x = jω/`frequency_scale`, H = 1; n_b > n_a is allowed:

        A = x^{n_a} + a_1 x^{n_a−1} + … + a_{n_a},   B = b_0 x^{n_b} + … + b_{n_b}

    With `delay`, G carries a further factor e^{−jωτ}, τ in seconds. The coefficients stand in the vector
    ζ = (a_1 …, b_0 …, [τ], c_1 …, d_1 …) of size n; its first `n_plant` entries are ζ_G, the others ζ_H.
    """

    n_a: int
    n_b: int
    n_k: int = 0
    n_c: int = 0
    n_d: int = 0
    sample_time: float | None = None
    frequency_scale: float = 1.0
    delay: bool = False

    def __post_init__(self) -> None:
        for name in ("n_a", "n_b", "n_k", "n_c", "n_d"):
            if getattr(self, name) < 0:
                raise RangeError(f"{name} is {getattr(self, name)}; orders must be zero or more", name)
        if self.sample_time is None and (self.n_k or self.n_c or self.n_d):
            raise RangeError("n_k, n_c and n_d belong to discrete time; leave them at zero in continuous time", "n_k")
        if self.sample_time is not None:
            require_positive(self.sample_time, "sample time")
        require_positive(self.frequency_scale, "frequency scale")

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Each coefficient by itself: a1 …, b0 …, tau, c1 …, d1 …"""
        counted = (("a", 1, self.n_a), ("b", 0, self.n_b + 1), ("c", 1, self.n_c), ("d", 1, self.n_d))
        a, b, c, d = ([f"{letter}{first + i}" for i in range(count)] for letter, first, count in counted)
        plant = (Group(name, (name,)) for name in (*a, *b, *(["tau"] if self.delay else [])))
        return (*plant, *(Group(name, (name,), of_noise=True) for name in (*c, *d)))

    @property
    def order(self) -> int:
        """n_a."""
        return self.n_a

    @property
    def transients(self) -> int:
        """max(n_a, n_b + n_k) in discrete time, where the input before the record is not known either."""
        return max(self.n_a, self.n_b + self.n_k) if self.is_discrete else self.n_a

    def split(self, zeta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """(a, b, τ, c, d) of ζ (…, n), without the leading ones; τ has a last axis of size 0 or 1."""
        if zeta.shape[-1] != self.size:
            raise ShapeError(f"ζ has {zeta.shape[-1]} entries, this structure has {self.size}", "zeta")
        ends = np.cumsum([self.n_a, self.n_b + 1, int(self.delay), self.n_c])
        a, b, tau, c, d = np.split(zeta, ends, axis=-1)
        return a, b, tau, c, d

    def dead_time(self, zeta: FloatArray) -> FloatArray:
        """n_k T + τ."""
        late = self.n_k * (self.sample_time or 0.0)
        return np.asarray(late + self.split(zeta)[2].sum(axis=-1))

    @property
    def plain(self) -> "RationalStructure":
        """Itself: the leading coefficient of A is one."""
        return self

    def to_plain(self, zeta: FloatArray) -> FloatArray:
        """ζ as it is."""
        return zeta

    def of_plain(self, plain: FloatArray) -> FloatArray:
        """ζ as it is."""
        return plain

    def covariance_of_plain(self, zeta: FloatArray, covariance: FloatArray) -> FloatArray:
        """The covariance as it is."""
        return covariance

    def affine(self, omega: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray, ComplexArray]:
        """A_0 (F,), ∂A (n, F), B_0 (F,), ∂B (n, F) of A = A_0 + ζᵀ∂A, B = B_0 + ζᵀ∂B in (a_1 …, b_0 …)."""
        numerator, denominator = self.powers(omega)
        a = np.concatenate([denominator[1:], np.zeros_like(numerator)])
        b = np.concatenate([np.zeros_like(denominator[1:]), numerator])
        return denominator[0], a, np.zeros_like(denominator[0]), b

    def response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """That of one input and output, as (…, F, 1, 1)."""
        return self.plant_response(zeta, omega)[..., None, None]

    def gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """That of one input and output, as (…, F, 1, 1, n_plant)."""
        return np.swapaxes(self.plant_gradient(zeta, omega), -1, -2)[..., None, None, :]

    def plant_response(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """G(ω; ζ) for ζ (…, n) and ω (F,) in rad/s, as (…, F)."""
        if held is not None and not self.is_discrete:
            return np.stack([held_ratio(*one, omega, held) for one in self._polynomials(zeta)]).reshape(
                *zeta.shape[:-1], -1
            )
        a, b, tau, _, _ = self.split(zeta)
        numerator_powers, denominator_powers = self.powers(omega)
        return self._delay_factor(tau, omega) * (b @ numerator_powers) / _monic(a, denominator_powers)

    def plant_gradient(self, zeta: FloatArray, omega: FloatArray, held: HeldInput | None = None) -> ComplexArray:
        """∂G/∂ζ_G for ζ (…, n) and ω (F,), as (…, n_plant, F)."""
        if held is not None and not self.is_discrete:
            rows = [held_ratio_gradient(*one, omega, held) for one in self._polynomials(zeta)]
            return np.stack(rows)[:, : self.n_plant].reshape(*zeta.shape[:-1], self.n_plant, -1)
        a, b, tau, _, _ = self.split(zeta)
        numerator_powers, denominator_powers = self.powers(omega)
        over_a = (self._delay_factor(tau, omega) / _monic(a, denominator_powers))[..., None, :]
        response = over_a * (b @ numerator_powers)[..., None, :]
        ratio = over_a / self._delay_factor(tau, omega)[..., None, :]
        parts = [-response * ratio * denominator_powers[1:], over_a * numerator_powers]
        if self.delay:
            parts.append(-1j * omega * response)
        return np.concatenate(parts, axis=-2)

    def _polynomials(self, zeta: FloatArray) -> Iterator[tuple[FloatArray, FloatArray, float, float]]:
        """A with its leading one, B, τ and the scale of s, of each ζ in turn; raises MisuseError for n_b > n_a."""
        if self.n_b > self.n_a:
            raise MisuseError(
                "the input was held between its samples, and a model with n_b > n_a would answer its steps with"
                " impulses; choose n_b ≤ n_a, or state that the input is band limited",
                "n_b",
            )
        for one in zeta.reshape(-1, zeta.shape[-1]):
            a, b, tau, _, _ = self.split(one)
            yield np.concatenate([[1.0], a]), b, float(tau[0]) if self.delay else 0.0, self.frequency_scale

    def noise_response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """H(ω; ζ) for ζ (…, n) and ω (F,), as (…, F)."""
        _, _, _, c, d = self.split(zeta)
        return _monic(c, self._noise_powers(omega, self.n_c)) / _monic(d, self._noise_powers(omega, self.n_d))

    def noise_gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """∂H/∂ζ_H for ζ (…, n) and ω (F,), as (…, n_noise, F)."""
        _, _, _, c, d = self.split(zeta)
        c_powers, d_powers = self._noise_powers(omega, self.n_c), self._noise_powers(omega, self.n_d)
        over_d = 1 / _monic(d, d_powers)[..., None, :]
        response = _monic(c, c_powers)[..., None, :] * over_d
        return np.concatenate([over_d * c_powers[1:], -response * over_d * d_powers[1:]], axis=-2)

    def sampled(self, zeta: FloatArray, step: float) -> tuple[FloatArray, FloatArray] | None:
        """In observable form; None for a direct path, a delay of more than one sample or an estimated one."""
        n, late = self.n_a, self.n_k - 1 if self.is_discrete else self.n_a - 1 - self.n_b
        if late < 0 or late + self.n_b >= n or self.delay:
            return None
        a, b, _, _, _ = self.split(zeta)
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = np.eye(n, k=1)
        matrix[:n, 0] = -a
        matrix[late : late + self.n_b + 1, n] = b
        if self.is_discrete:
            matrix[n, n] = 1.0
            return matrix, np.eye(1, n)[0]
        return expm(matrix * (self.frequency_scale * step)), np.eye(1, n)[0]

    def without_direct_path(self, zeta: FloatArray) -> tuple[Structure, FloatArray, float]:
        """In continuous time for n_b = n_a > 0 without a delay."""
        if self.is_discrete or self.delay or self.n_b != self.n_a or self.n_a == 0:
            return self, zeta, 0.0
        a, b, *_ = self.split(zeta)
        rest = RationalStructure(self.n_a, self.n_a - 1, frequency_scale=self.frequency_scale)
        return rest, np.concatenate([a, b[1:] - b[0] * a]), float(b[0])

    def poles(self, zeta: FloatArray) -> ComplexArray:
        """Poles of G for ζ (…, n), as (…, n_a): in the z-plane, or in rad/s in continuous time."""
        scale = 1.0 if self.is_discrete else self.frequency_scale
        return scale * roots(self.split(zeta)[0])

    def pole_gradient(self, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """∂x/∂a_i = −x^{n_a − i} / A′(x) at the zeros x of A, in the unit of the poles."""
        scale = 1.0 if self.is_discrete else self.frequency_scale
        zeros = roots(self.split(zeta)[0])
        differences = zeros[..., :, None] - zeros[..., None, :] + np.eye(self.n_a)
        powers = zeros[..., None] ** np.arange(self.n_a - 1, -1, -1)
        gradient = np.zeros((*zeros.shape, self.n_plant), dtype=np.complex128)
        gradient[..., : self.n_a] = -scale * powers / differences.prod(axis=-1)[..., None]
        return np.asarray(scale * zeros), gradient

    def difference_equation(self) -> DifferenceEquation:
        """Its own orders; raises MisuseError in continuous time, or with an estimated delay."""
        if self.sample_time is None or self.delay:
            return super().difference_equation()
        return DifferenceEquation(self.n_a, self.n_b, self.n_k, self.sample_time)

    def along(self, zeta: FloatArray, input: FloatArray) -> Along:
        """The difference equation with coefficients that follow p(t) at once.

        y(t) = −Σ_i a_i(p(t)) y(t−i) + Σ_i b_i(p(t)) u(t−n_k−i) = φ(t)ᵀ ζ_G(p(t))
        δy(t) = −Σ_i a_i(p(t)) δy(t−i) + φ(t)ᵀ δζ_G(p(t))
        """
        if not self.is_discrete or self.delay:
            raise MisuseError(NOT_ALONG, "model")
        past = np.stack([_delayed(input[:, 0], self.n_k + i) for i in range(self.n_b + 1)], axis=1)
        transition = _companion(zeta[:, : self.n_a])
        y = _filtered(transition, np.sum(zeta[:, self.n_a : self.n_plant] * past, axis=1))
        phi = np.concatenate([*(-_delayed(y, i + 1)[:, None] for i in range(self.n_a)), past], axis=1)
        return Along(y[:, None], lambda moved: _filtered(transition, np.sum(phi * moved, axis=1))[:, None])

    def radius(self, zeta: FloatArray) -> FloatArray:
        """The largest modulus of a root of A, C or D in the z-plane, for ζ (…, n), as (…,); discrete time only."""
        a, _, _, c, d = self.split(zeta)
        return np.asarray(np.max([abs(roots(x)).max(axis=-1, initial=0.0) for x in (a, c, d)], axis=0))

    def characteristic(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """A (…, 1 + n_a, F) and its derivatives by a_1 …."""
        a, powers = self.split(zeta)[0], self.powers(omega)[1]
        by_a = np.broadcast_to(powers[1:], (*a.shape[:-1], *powers[1:].shape))
        return np.concatenate([_monic(a, powers)[..., None, :], by_a], axis=-2)

    def powers(self, omega: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """The powers that B and A are sums of, lowest coefficient first, (n_b + 1, F) and (n_a + 1, F)."""
        numerator, denominator = np.arange(self.n_b + 1)[:, None], np.arange(self.n_a + 1)[:, None]
        if self.sample_time is not None:
            q = np.exp(-1j * omega * self.sample_time)
            return q ** (self.n_k + numerator), q**denominator
        x = 1j * omega / self.frequency_scale
        return np.asarray(x ** numerator[::-1]), np.asarray(x ** denominator[::-1])

    def _noise_powers(self, omega: FloatArray, order: int) -> ComplexArray:
        q = np.exp(-1j * omega * (self.sample_time or 0.0))
        return np.asarray(q ** np.arange(order + 1)[:, None])

    def _delay_factor(self, tau: FloatArray, omega: FloatArray) -> ComplexArray:
        if not self.delay:
            return np.ones(1, dtype=np.complex128)
        return np.asarray(np.exp(-1j * omega * tau))


def _monic(coefficients: FloatArray, powers: ComplexArray) -> ComplexArray:
    return np.asarray(powers[0] + coefficients @ powers[1:])


def roots(coefficients: FloatArray) -> ComplexArray:
    """Zeros of x^m + c_1 x^{m−1} + … + c_m for coefficients c (…, m), as (…, m)."""
    order = coefficients.shape[-1]
    if order <= 1:
        return np.asarray(-coefficients, dtype=np.complex128)
    companion = np.zeros((*coefficients.shape, order))
    companion[..., 0, :] = -coefficients
    companion[..., np.arange(1, order), np.arange(order - 1)] = 1.0
    return np.asarray(np.linalg.eigvals(companion), dtype=np.complex128)


def _delayed(signal: FloatArray, lag: int) -> FloatArray:
    lag = min(lag, len(signal))
    return np.concatenate([np.zeros(lag), signal[: len(signal) - lag]])


def _companion(a: FloatArray) -> FloatArray:
    """F(t) (N, n, n) of x(t+1) = F(t) x(t) + e_1 w(t), x(t) = (y(t−1), …, y(t−n))."""
    count, n = a.shape
    found = np.zeros((count, n, n))
    if n:
        found[:, 0] = -a
        found[:, np.arange(1, n), np.arange(n - 1)] = 1.0
    return found


def _filtered(transition: FloatArray, forcing: FloatArray) -> FloatArray:
    """y (N,) with y(t) = first entry of x(t+1)."""
    count, n = transition.shape[:2]
    if n == 0:
        return forcing
    driven = np.zeros((count, n))
    driven[:, 0] = forcing
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(propagate(transition, driven, np.zeros(n))[1:, 0])
