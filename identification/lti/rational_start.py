"""Linear starts for rational models on frequency responses: Levy, and Sanathanan–Koerner in orthonormal bases."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError
from identification.lti.delay_search import coherent_delays
from identification.lti.likelihood import require_same_sampling
from identification.lti.rational_basis import (
    LinearProblem,
    as_zeta,
    frequency_scale,
    from_poles,
    inner,
    mapped,
    orthonormal,
    rescale,
    stabilised,
)
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse

DELAY_ITERATIONS = 6
FINEST = 2000
SETTLED = 1e-4

Basis = tuple[ComplexArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Starts:
    """Candidates: ζ (K, n) and the weighted cost Σ w²|Ĝ − G(ζ)|² of each, (K,); infinite where a candidate failed."""

    zeta: FloatArray
    cost: FloatArray

    def best(self, count: int) -> "Starts":
        """The `count` cheapest ones, cheapest first, leaving out repetitions of one cost and failures."""
        order = np.argsort(self.cost, kind="stable")
        kept: list[int] = []
        for i in order[np.isfinite(self.cost[order])]:
            if not kept or self.cost[i] > self.cost[kept[-1]] * (1 + 1e-4):
                kept.append(int(i))
        return Starts(self.zeta[kept[:count]], self.cost[kept[:count]])

    def around_minima(self, count: int) -> "Starts":
        """Up to `count` of these: the cheapest local minima over τ, the last coefficient, and larger τ next to each."""
        tau, first = np.unique(self.zeta[:, -1], return_index=True)
        padded = np.concatenate([[np.inf], self.cost[first], [np.inf]])
        lowest = np.flatnonzero(
            (padded[1:-1] <= padded[:-2]) & (padded[1:-1] <= padded[2:]) & np.isfinite(padded[1:-1])
        )
        ranked = lowest[np.argsort(self.cost[first][lowest], kind="stable")]
        wanted = (ranked[:, None] + np.arange(5)).ravel()
        order = list(dict.fromkeys(wanted[wanted < len(tau)].tolist()))[:count]
        usable = [i for i in first[order] if np.isfinite(self.cost[i])]
        return Starts(self.zeta[usable], self.cost[usable])


def levy(structure: RationalStructure, data: FrequencyResponse, delay: float = 0.0) -> FloatArray:
    """Levy's linear least-squares fit, ζ (n,), biased wherever |A| varies over the band or the data are noisy.

        min Σ_k |Ĝ_k e^{jω_k τ} A(ω_k) − B(ω_k)|²   with the constant coefficient of A equal to one   [Levy1959]

    A known delay τ in s may be given. Solved in a basis that is orthonormal on the lines, then turned into ζ.
    Raises MisuseError where the structure does not fit the data and RangeError where the fit puts a pole at infinity.
    """
    require_same_sampling(structure, data)
    scaled = replace(structure, frequency_scale=frequency_scale(structure, data))
    problem = LinearProblem.of(scaled, data, np.ones(len(data)))
    basis = orthonormal(problem, np.ones((1, len(data))))
    step = _linear_step(problem, basis, problem.advanced(np.array([delay])))
    constant = np.real(step.coefficients[0, 0, : structure.n_a + 1])
    _, values, right = np.linalg.svd(step.triangle[0])
    inverse = np.where(values > values[-1], values[-1] / np.where(values > 0, values, 1.0), 1.0) ** 2
    t = right.T @ (inverse * (right @ constant))
    a = step.coefficients[0, : structure.n_a + 1, : structure.n_a + 1] @ t
    b = step.coefficients[0, : structure.n_b + 1, : structure.n_b + 1] @ step.numerator(t[None])[0]
    zeta = as_zeta(scaled, a[None], b[None], np.array([delay]))[0]
    if not np.all(np.isfinite(zeta)):
        raise RangeError("the linear fit has a pole at infinity; choose a lower order of the denominator", "n_a")
    return np.asarray(rescale(scaled, structure.frequency_scale) * zeta)


def linear_starts(problem: LinearProblem, stable: bool, iterations: int = 20, count: int = 3) -> Starts:
    """The best few starts from Sanathanan–Koerner iterations with several first denominators and, with a delay, many τ.

        min Σ_k w_k² |(Ĝ_k A − B)/A_prev|²,   Σ_k w_k² |A/A_prev|² = 1          [Sanathanan1963]

    The polynomials stand in a basis x^j/A_prev made orthonormal on the lines; it spans what the partial fractions of
    vector fitting span [Gustavsen1999]. The norm in the constraint is that of the noise, so that the fit is consistent.
    With `stable` every candidate is judged with its poles reflected into the stable region. With a delay the starts
    differ in τ, and many of them should be tried: where τ is a little too small, zeros can imitate what is missing.
    """
    first = first_denominators(problem)
    if not problem.structure.delay:
        return _iterate(problem, first, np.zeros(len(first)), stable, iterations).best(count)
    return _scan_delays(problem, first, stable).around_minima(count)


def _scan_delays(problem: LinearProblem, first: FloatArray, stable: bool) -> Starts:
    """The best rational part at each delay of the grid; where the band is narrow, on grids that resolve its phase."""
    taus = delay_grid(problem)
    found = _iterate(problem, np.repeat(first[:1], len(taus), axis=0), taus, stable, DELAY_ITERATIONS)
    for start in first[1:]:
        other = _iterate(problem, np.repeat(start[None], len(taus), axis=0), taus, stable, DELAY_ITERATIONS)
        better = other.cost < found.cost
        found.zeta[better], found.cost[better] = other.zeta[better], other.cost[better]
    finer = np.ceil(problem.omega[-1] / (problem.omega[-1] - problem.omega[0] + 1e-300))
    if finer < 2 or len(taus) < 2:
        return found
    tau = np.interp(np.linspace(0, 1, int(min(finer * len(taus), FINEST))), np.linspace(0, 1, len(taus)), taus)
    nearest = abs(tau[:, None] - taus).argmin(axis=1)
    return _iterate(problem, _magnitudes(problem, found.zeta)[nearest], tau, stable, DELAY_ITERATIONS)


def _magnitudes(problem: LinearProblem, zeta: FloatArray) -> FloatArray:
    """|A| on the lines (K, F) for ζ (K, n)."""
    n_a = problem.structure.n_a
    a = np.concatenate([np.ones((len(zeta), 1)), zeta[:, :n_a]], axis=1)
    powers = np.arange(n_a + 1)[:, None]
    values = abs(a @ problem.x ** (powers if problem.structure.is_discrete else powers[::-1]))
    return np.asarray(np.maximum(values, 1e-12 * values.max(axis=1, keepdims=True)))


def first_denominators(problem: LinearProblem) -> FloatArray:
    """|A_prev| to begin with, (K, F): one (Levy), real poles, lightly damped pairs of poles over the band."""
    n_a, positive = problem.structure.n_a, problem.omega[problem.omega > 0]
    if n_a == 0 or len(positive) == 0:
        return np.ones((1, len(problem.omega)))
    low, high = positive.min(), positive.max()
    pairs = n_a // 2
    real = -np.geomspace(low, high, n_a + 2)[1:-1]
    rest = [-np.sqrt(low * high)] * (n_a % 2)
    sets = [real.astype(complex)]
    if pairs:
        for centres in (np.geomspace(low, high, pairs + 2)[1:-1], np.linspace(low, high, pairs + 2)[1:-1]):
            upper = centres * (-0.05 + 1j)
            sets.append(np.concatenate([upper, upper.conj(), rest]))
    values = [np.abs(from_poles(problem, mapped(problem, poles)[None])[0]) for poles in sets]
    return np.stack([np.ones(len(problem.omega)), *values])


def delay_grid(problem: LinearProblem) -> FloatArray:
    """Delays τ ≥ 0 in s to try, (K,), an eighth of a turn apart over the band.

    They lie around the delay that the phase shows, unwrapped, and around the best three of `coherent_delays`, as far as
    n_a + n_b poles and zeros can turn the phase, and one turn further.
    """
    steps = np.diff(problem.omega)
    if len(steps) == 0:
        return np.zeros(1)
    span = problem.omega[-1] - problem.omega[0]
    turns = problem.response[1:] * problem.response[:-1].conj()
    turns = turns / np.maximum(abs(turns), np.finfo(float).tiny)
    unwrapped = -np.sum(np.angle(turns)) / span
    spacing = delay_spacing(problem)
    coherent = coherent_delays(problem.omega, turns)
    reach = int(np.ceil(((problem.structure.n_a + problem.structure.n_b) * np.pi / 2 + 2 * np.pi) / span / spacing))
    window = spacing * np.arange(-reach, reach + 1)
    grid = np.concatenate([[0.0], unwrapped + window, (coherent[:, None] + window).ravel()])
    return np.unique(grid[grid >= 0])


def delay_spacing(problem: LinearProblem) -> float:
    """An eighth of a turn over the band, in s."""
    span = float(problem.omega[-1] - problem.omega[0])
    return np.pi / (4 * span) if span > 0 else 0.0


@dataclass(frozen=True, eq=False)
class _Step:
    """One linearised problem in its basis: `coefficients` (K, m, m) of the basis, B from A, and R of what is left."""

    coefficients: FloatArray
    projection: FloatArray
    triangle: FloatArray

    def numerator(self, denominator: FloatArray) -> FloatArray:
        return np.asarray((self.projection @ denominator[..., None])[..., 0])


def _linear_step(problem: LinearProblem, basis: Basis, advanced: ComplexArray) -> _Step:
    structure, (values, coefficients) = problem.structure, basis
    numerator = values[..., : structure.n_b + 1]
    rest = advanced[..., None] * values[..., : structure.n_a + 1]
    projection = np.zeros((len(values), structure.n_b + 1, structure.n_a + 1))
    for _ in range(2):
        part = inner(numerator, rest)
        rest = rest - numerator @ part
        projection = projection + part
    triangle = np.linalg.qr(np.concatenate([rest.real, rest.imag], axis=1), mode="r")
    return _Step(coefficients, projection, np.asarray(triangle))


def _iterate(problem: LinearProblem, first: FloatArray, tau: FloatArray, stable: bool, iterations: int) -> Starts:
    """Sanathanan–Koerner from |A_prev| (K, F) at delays τ (K,), all at once; the best iterate of each is kept."""
    structure, magnitude, advanced = problem.structure, first, problem.advanced(tau)
    basis = orthonormal(problem, magnitude)
    zeta, cost = np.zeros((len(tau), structure.size)), np.full(len(tau), np.inf)
    for _ in range(iterations if structure.n_a else 1):
        before = magnitude
        a, denominator, magnitude = _denominator(problem, _linear_step(problem, basis, advanced), stable)
        basis = orthonormal(problem, magnitude)
        b, new_cost = _numerator(problem, basis, problem.weights * advanced * denominator / magnitude)
        new_zeta = as_zeta(structure, a, b, tau)
        better = (new_cost < cost) & np.all(np.isfinite(new_zeta), axis=-1)
        zeta[better], cost[better] = new_zeta[better], new_cost[better]
        if np.all(abs(magnitude - before) <= SETTLED * magnitude):
            break
    return Starts(zeta, cost)


def _denominator(problem: LinearProblem, step: _Step, stable: bool) -> tuple[FloatArray, ComplexArray, FloatArray]:
    """A that solves a linearised problem: ascending coefficients, values of size one at most, and sizes, not zero."""
    structure = problem.structure
    t = np.linalg.svd(step.triangle)[2][:, -1, :]
    a = (step.coefficients[:, : structure.n_a + 1, : structure.n_a + 1] @ t[..., None])[..., 0]
    a = stabilised(structure, a) if stable else a
    powers = problem.x ** np.arange(structure.n_a + 1)[:, None]
    level = abs(a @ powers).max(axis=1, keepdims=True)
    a = a / level
    denominator = a @ powers
    return a, denominator, np.maximum(abs(denominator), 1e-12 * (abs(a) @ abs(powers)))


def _numerator(problem: LinearProblem, basis: Basis, target: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """The best B (K, n_b + 1), ascending, for w Ĝ A/|A| (K, F) and the basis of that |A|, and the cost (K,)."""
    count = problem.structure.n_b + 1
    values, coefficients = basis[0][..., :count], basis[1][:, :count, :count]
    b = inner(values, target[..., None])
    rest = target - (values @ b)[..., 0]
    return (coefficients @ b)[..., 0], np.sum(abs(rest) ** 2, axis=-1)
