"""Models in continuous time as they are seen through an input that is held between its samples."""

import numpy as np
from scipy.linalg import expm

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.models.rational import RationalStructure
from identification.resolvent import resolvent_by_entry
from identification.signals import FrequencyResponse, HeldInput


def held_response(
    structure: RationalStructure, zeta: FloatArray, omega: FloatArray, held: HeldInput | None
) -> ComplexArray:
    """What the samples of the output answer to samples of the input, for ζ (…, n) and ω (F,) in rad/s, as (…, F).

        H(e^{jωT}) = Σ_m G(j(ω + 2πm/T)) P(j(ω + 2πm/T))/T,   P(s) = (1 − e^{−sT})/s, or e^{sT}((1 − e^{−sT})/s)²/T

    for a zero-order hold and for straight lines between the samples, exact at every ω: x(t + T) = e^{AT} x(t) + Γ u
    with a realisation of G [AstromWittenmark1997, (2.4)]. `held` None, and models in discrete time: G(ω) itself.
    Raises MisuseError for n_b > n_a, which would answer the steps of a held input with impulses.
    """
    if held is None or structure.is_discrete:
        return structure.plant_response(zeta, omega)
    _require_proper(structure)
    rows = [_response(structure, one, omega, held) for one in zeta.reshape(-1, zeta.shape[-1])]
    return np.array(rows).reshape(*zeta.shape[:-1], len(omega))


def held_gradient(
    structure: RationalStructure, zeta: FloatArray, omega: FloatArray, held: HeldInput | None
) -> ComplexArray:
    """∂H/∂ζ_G of `held_response` for ζ (…, n) and ω (F,), exact, as (…, n_plant, F).

    Every derivative of B/A is a polynomial over A², so that all of them follow from one realisation of 1/A².
    """
    if held is None or structure.is_discrete:
        return structure.plant_gradient(zeta, omega)
    _require_proper(structure)
    rows = [_gradient(structure, one, omega, held) for one in zeta.reshape(-1, zeta.shape[-1])]
    return np.array(rows).reshape(*zeta.shape[:-1], structure.n_plant, len(omega))


def hold_factor(omega: FloatArray, held: HeldInput) -> ComplexArray:
    """P(jω)/T (F,): what the hold does to the band below the Nyquist frequency, images left aside."""
    turn = omega * held.step
    shape = np.sinc(turn / (2 * np.pi))
    return np.asarray(shape * np.exp(-0.5j * turn) if held.hold == "zero" else shape**2 + 0j)


def without_hold(data: FrequencyResponse) -> ComplexArray:
    """The response (F,) with the factor of the hold divided out: that of the plant, but for images."""
    return data.response if data.held is None else data.response / hold_factor(data.frequencies, data.held)


def _require_proper(structure: RationalStructure) -> None:
    if structure.n_b > structure.n_a:
        raise MisuseError(
            "the input was held between its samples, and a model with n_b > n_a would answer its steps with impulses;"
            " choose n_b ≤ n_a, or state that the input is band limited",
            "n_b",
        )


def _response(structure: RationalStructure, zeta: FloatArray, omega: FloatArray, held: HeldInput) -> ComplexArray:
    a, b, tau = _polynomials(structure, zeta)
    powers, _ = _powers_over(a, structure.frequency_scale, omega, held, tau)
    return np.asarray(_padded(b, len(a)) @ powers)


def _gradient(structure: RationalStructure, zeta: FloatArray, omega: FloatArray, held: HeldInput) -> ComplexArray:
    a, b, tau = _polynomials(structure, zeta)
    scale, n_a, n_b = structure.frequency_scale, structure.n_a, structure.n_b
    powers, slope = _powers_over(np.convolve(a, a), scale, omega, held, tau)
    size = 2 * n_a + 1
    by_a = [_padded(-_shifted(b, n_a - i), size) for i in range(1, n_a + 1)]
    by_b = [_padded(_shifted(a, n_b - i), size) for i in range(n_b + 1)]
    rows = np.array([*by_a, *by_b]) @ powers
    if not structure.delay:
        return rows
    direct = b[0] if n_b == n_a else 0.0
    rest = _padded(b, n_a + 1) - direct * a
    by_delay = _padded(-scale * np.convolve(_shifted(rest[1:], 1), a), size) @ powers if n_a else 0.0
    return np.concatenate([rows, np.atleast_2d(by_delay - direct * slope)])


def _polynomials(structure: RationalStructure, zeta: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """A with its leading one, B and τ."""
    a, b, tau, _, _ = structure.split(zeta)
    return np.concatenate([[1.0], a]), b, float(tau[0]) if structure.delay else 0.0


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
