"""Ratios of polynomials in s as they are seen through an input that is held between its samples."""

import numpy as np
from scipy.linalg import expm

from identification.arrays import ComplexArray, FloatArray
from identification.models.resolvent import resolvent_by_entry
from identification.signals import FrequencyResponse, HeldInput


def hold_factor(omega: FloatArray, held: HeldInput) -> ComplexArray:
    """P(jω)/T (F,): what the hold does to the band below the Nyquist frequency, images left aside."""
    turn = omega * held.step
    shape = np.sinc(turn / (2 * np.pi))
    return np.asarray(shape * np.exp(-0.5j * turn) if held.hold == "zero" else shape**2 + 0j)


def without_hold(data: FrequencyResponse) -> ComplexArray:
    """The response (F,) with the factor of the hold divided out: that of the plant, but for images."""
    return data.response if data.held is None else data.response / hold_factor(data.frequencies, data.held)


def held_ratio(
    a: FloatArray, b: FloatArray, tau: float, scale: float, omega: FloatArray, held: HeldInput
) -> ComplexArray:
    """What the samples of the output answer to samples of the input of e^{−sτ} B/A at ω (F,) in rad/s, as (F,).

        H(e^{jωT}) = Σ_m G(j(ω + 2πm/T)) P(j(ω + 2πm/T))/T,   P(s) = (1 − e^{−sT})/s, or e^{sT}((1 − e^{−sT})/s)²/T

    for a zero-order hold and for straight lines between the samples, exact at every ω: x(t + T) = e^{AT} x(t) + Γ u
    with a realisation of G [AstromWittenmark1997, (2.4)]. `a` (n_a + 1,) with its leading one and `b` (n_b + 1,) in
    powers of s/`scale`, the highest first, n_b ≤ n_a.
    """
    powers, _ = _powers_over(a, scale, omega, held, tau)
    return np.asarray(_padded(b, len(a)) @ powers)


def held_ratio_gradient(
    a: FloatArray, b: FloatArray, tau: float, scale: float, omega: FloatArray, held: HeldInput
) -> ComplexArray:
    """Derivatives of `held_ratio` by a_1 …, b_0 … and τ, exact, as (n_a + n_b + 2, F).

    Every derivative of B/A is a polynomial over A², so that all of them follow from one realisation of 1/A².
    """
    n_a, n_b = len(a) - 1, len(b) - 1
    powers, slope = _powers_over(np.convolve(a, a), scale, omega, held, tau)
    size = 2 * n_a + 1
    by_a = [_padded(-_shifted(b, n_a - i), size) for i in range(1, n_a + 1)]
    by_b = [_padded(_shifted(a, n_b - i), size) for i in range(n_b + 1)]
    rows = np.array([*by_a, *by_b]) @ powers
    direct = b[0] if n_b == n_a else 0.0
    rest = _padded(b, n_a + 1) - direct * a
    by_delay = _padded(-scale * np.convolve(_shifted(rest[1:], 1), a), size) @ powers if n_a else 0.0
    return np.concatenate([rows, np.atleast_2d(by_delay - direct * slope)])


def _shifted(polynomial: FloatArray, power: int) -> FloatArray:
    """A polynomial, highest power first, times x^power."""
    return np.concatenate([polynomial, np.zeros(power)])


def _padded(polynomial: FloatArray, size: int) -> FloatArray:
    """A polynomial with zeros for powers that it lacks, (size,)."""
    return np.concatenate([np.zeros(size - len(polynomial)), polynomial])


def _powers_over(
    denominator: FloatArray, scale: float, omega: FloatArray, held: HeldInput, tau: float
) -> tuple[ComplexArray, ComplexArray]:
    """What x^m/D, …, 1/D (m + 1, F), x = s/scale, answer to a held input τ later; and the slope of that input (F,).

    The states of the companion form are x^{m−1}/D, …, 1/D themselves; x^m/D is the input less what A feeds back.
    With τ = dT − δ, 0 ≤ δ < T, the output is looked at δ after each sample, d samples later.
    """
    m, step, moving = len(denominator) - 1, held.step, omega > 0
    z = np.exp(1j * omega * step)
    late = int(np.ceil(tau / step - 1e-12))
    rest = max(late * step - tau, 0.0)
    later = z**-late
    change = z - 1 if held.hold == "first" else np.zeros_like(z)
    level = later * (1 + change * rest / step)
    if m == 0:
        return level[None], later * change / step
    dynamics = np.zeros((m + 2, m + 2))
    dynamics[1:m, : m - 1] = scale * np.eye(m - 1)
    dynamics[0, :m], dynamics[0, m] = -scale * denominator[1:], scale
    dynamics[m, m + 1] = 1 / step
    whole, part = expm(dynamics * step), expm(dynamics * rest)
    states = np.zeros((m, len(z)), dtype=np.complex128)
    identity = np.eye(m)
    found = resolvent_by_entry(whole[:m, :m], whole[:m, m:], identity, z[moving])
    states[:, moving] = found[:, 0] + found[:, 1] * change[moving]
    seen = later * (part[:m, :m] @ states + part[:m, m, None] + part[:m, m + 1, None] * change)
    with np.errstate(divide="ignore", invalid="ignore"):
        seen[:, ~moving] = (np.eye(m)[-1] / denominator[-1])[:, None]
    return np.concatenate([(level - denominator[1:] @ seen)[None], seen]), later * change / step
