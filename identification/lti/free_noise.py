"""Prediction errors of a record in a loop, with a noise model that is as rich as the data ask for."""

from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.linalg import qr

from identification.arrays import FloatArray
from identification.least_squares import levenberg_marquardt
from identification.lti.box_jenkins_start import waves
from identification.lti.filtering import lfilter
from identification.lti.likelihood import delayed
from identification.models.rational import RationalStructure, roots
from identification.signals import TimeRecord

ORDERS = (0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 26, 32, 40)
EACH, PATIENCE, ITERATIONS, MOST_COLOUR = 20, 2, 12, 2
SLOPE, OUTSIDE = 1e-6, 0.01
ONE = np.ones(1)


@dataclass(frozen=True, eq=False)
class RecordInLoop(TimeRecord):
    """A record with feedback whose noise (C/D) e is not among the parameters: D of `noise_order` p, C by `colour`."""

    noise_order: int = 0
    colour: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class LoopErrors:
    """ε (N,), ∂ε/∂ζ (N, n) and by the coefficients of C (N, n_c), an orthonormal basis (N, c) of what was projected
    out, and the disturbance v (N,)."""

    errors: FloatArray
    jacobian: FloatArray
    by_colour: FloatArray
    nuisance: FloatArray
    disturbance: FloatArray


def with_free_noise(structure: RationalStructure, record: TimeRecord) -> RecordInLoop:
    """A fitted record with the noise model C/D of least N ln ‖ε‖² + (n_c + p) ln N [Schwarz1978].

    Orders p go up from zero until two in turn are worse, first without C, then with one and two coefficients of it as
    long as that helps. The plant is fitted anew each time: v of one that is only nearly right asks for too much.
    """
    made = {one.name: getattr(record, one.name) for one in fields(record)}
    best = _Tried(RecordInLoop(**made), np.zeros(0), np.inf)
    for n_c in range(MOST_COLOUR + 1):
        before, worse, last = best.criterion, 0, best
        for p in ORDERS if n_c == 0 else range(max(best.record.noise_order - 6, n_c), n_c + 3):
            if EACH * (p + n_c + structure.size) >= len(record):
                break
            looped = RecordInLoop(**made, noise_order=p, colour=(0.0,) * n_c)
            starts = [last.zeta] if len(last.zeta) else next(waves(structure, record))
            tried = [_tried(structure, looped, start) for start in starts]
            last = min(tried, key=lambda one: one.criterion, default=last)
            best, worse = (last, 0) if last.criterion < best.criterion else (best, worse + 1)
            if worse == PATIENCE:
                break
        if best.criterion >= before:
            break
    return best.record


@dataclass(frozen=True, eq=False)
class _Tried:
    """A record with its noise, the plant ζ fitted to it, and the criterion."""

    record: RecordInLoop
    zeta: FloatArray
    criterion: float


def _tried(structure: RationalStructure, record: RecordInLoop, start: FloatArray) -> _Tried:
    count = len(start)

    def coloured(x: FloatArray) -> RecordInLoop:
        return replace(record, colour=tuple(x[count:]))

    def evaluate(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = errors_in_loop(structure, x[:count], coloured(x))
        return found.errors, np.concatenate([found.jacobian, found.by_colour], axis=1)

    def feasible(x: FloatArray) -> bool:
        return bool(np.all(abs(roots(x[count:])) < 1))

    begun = np.concatenate([start, record.colour])
    found = levenberg_marquardt(evaluate, begun, feasible, ITERATIONS, 1e-4)
    cost = max(found.cost / (len(record) - record.noise_order), float(np.finfo(float).tiny))
    price = (record.noise_order + len(record.colour)) * np.log(len(record))
    return _Tried(coloured(found.x), found.x[:count], float(len(record) * np.log(cost) + price))


def errors_in_loop(structure: RationalStructure, zeta: FloatArray, record: RecordInLoop) -> LoopErrors:
    """The direct method [Forssell1999] with H = (C/D) A_s/A, D free of order p and minimised over.

        ε = (D v − X/A_s δ − ℓ)/C,   v = (A y − B u)/A_s,   A_s = A with its unstable zeros mirrored

    For a stable plant A_s = A and v = y − G u. The predictor of an unstable one is stable only if H shares its unstable
    poles; A/A_s is monic and changes the spectrum of v by the factor Π|zeros|² alone, which a likelihood of the output
    demands [ForssellLjung2000]. ε is multiplied by det(ΦᵀΦ)^(1/2N), Φ the responses to X, so that its least squares are
    those of the restricted likelihood [Harville1977]. The first p errors are left out (zero). D, the state X then and
    the level ℓ, where it was not stated, enter linearly and are projected out, and so is what the derivatives have in
    their directions: (JᵀJ)⁻¹ is the block of ζ in the covariance of all, which in a loop is not that for known noise.
    """
    a, b, *_ = structure.split(zeta)
    whole, colour = np.concatenate([ONE, a]), np.concatenate([ONE, record.colour])
    mirror, p = mirrored(whole), record.noise_order
    y, u = lfilter(ONE, np.convolve(mirror, colour), np.stack([record.output, record.input]))
    v = lfilter(whole, ONE, y) - lfilter(b, ONE, u)
    q, r = qr(_nuisance(v, np.convolve(mirror, colour), record, structure), mode="economic", check_finite=False)
    onto = q.T @ v[p:]
    found = np.linalg.lstsq(r, onto, rcond=1e-12)[0]
    errors = v[p:] - q @ onto
    noise = np.concatenate([ONE, -found[:p]])
    back = lfilter(ONE, mirror, errors + (0.0 if record.level_known else found[p]))
    y, u = (lfilter(noise, ONE, x) for x in (y, u))
    slopes = enumerate(_slopes(whole, mirror))
    of_a = [delayed(y, i + 1, 1)[p:, 0] - lfilter(slope, ONE, back) for i, slope in slopes]
    jacobian = np.concatenate([np.reshape(of_a, (len(a), -1)).T, -delayed(u, 0, structure.n_b + 1)[p:]], axis=1)
    by_colour = -delayed(lfilter(ONE, colour, errors), 1, len(record.colour))
    jacobian, by_colour = (x - q @ (q.T @ x) for x in (jacobian, by_colour))
    size, growth = _of_start(structure, whole, record)
    jacobian[:, : len(a)] += np.outer(errors, growth)
    scaled = (np.exp(size) * x for x in (errors, jacobian, by_colour))
    made = [np.concatenate([np.zeros((p, *x.shape[1:])), x]) for x in (*scaled, q)]
    return LoopErrors(made[0], made[1], made[2], made[3], lfilter(colour, ONE, v))


def _of_start(structure: RationalStructure, whole: FloatArray, record: RecordInLoop) -> tuple[float, FloatArray]:
    """ln det(ΦᵀΦ)/2N for what an unknown state makes of the record, and its derivatives by a: of a pole near one that
    is a drift over all of it, which would pass for a better fit."""
    samples, n = len(record) - record.noise_order, len(whole) - 1
    if n == 0:
        return 0.0, np.zeros(0)
    pulse = np.eye(samples, 1).ravel()

    def size(polynomial: FloatArray) -> float:
        free = delayed(lfilter(ONE, mirrored(polynomial), pulse), 0, n)
        return float(np.linalg.slogdet(free.T @ free)[1]) / (2 * samples)

    steps = SLOPE * np.eye(n + 1)[1:]
    return size(whole), np.array([(size(whole + step) - size(whole - step)) / (2 * SLOPE) for step in steps])


def marginal_errors(structure: RationalStructure, zeta: FloatArray, record: RecordInLoop) -> LoopErrors:
    """The same with the directions of C taken out of ∂ε/∂ζ and put among the nuisances: C is fitted, not known."""
    found = errors_in_loop(structure, zeta, record)
    if not record.colour:
        return found
    q = qr(found.by_colour, mode="economic", check_finite=False)[0]
    jacobian = found.jacobian - q @ (q.T @ found.jacobian)
    return replace(found, jacobian=jacobian, nuisance=np.concatenate([found.nuisance, q], axis=1))


def _nuisance(v: FloatArray, denominator: FloatArray, record: RecordInLoop, structure: RationalStructure) -> FloatArray:
    """Columns of D − 1, ℓ and X for the samples from p on."""
    p, samples = record.noise_order, len(v) - record.noise_order
    level = [] if record.level_known else [np.ones((samples, 1))]
    states = max(structure.n_a, structure.n_b) + len(record.colour)
    free = delayed(lfilter(ONE, denominator, np.eye(samples, 1).ravel()), 0, states)
    return np.concatenate([delayed(v, 1, p)[p:], *level, free], axis=1)


def mirrored(polynomial: FloatArray) -> FloatArray:
    """A monic polynomial in q^{−1} with its zeros outside the unit circle mirrored at it."""
    zeros = roots(polynomial[1:])
    if not np.any(abs(zeros) > 1):
        return polynomial
    return np.asarray(np.poly(np.where(abs(zeros) > 1, 1 / np.conj(zeros), zeros)).real)


def _slopes(whole: FloatArray, mirror: FloatArray) -> list[FloatArray]:
    """∂A_s/∂a_i as polynomials in q^{−1}: q^i where the plant is stable."""
    units = np.eye(len(whole))[1:]
    if mirror is whole:
        return list(units)
    return [(mirrored(whole + SLOPE * one) - mirrored(whole - SLOPE * one)) / (2 * SLOPE) for one in units]


def turned_out(structure: RationalStructure, zeta: FloatArray) -> FloatArray:
    """ζ with the pole nearest to the unit circle mirrored to the outside of it, with its conjugate, the gain kept."""
    a, b, *_ = structure.split(zeta)
    zeros = roots(a)
    nearest = abs(zeros) > abs(zeros).max() * (1 - 1e-9)
    moved = np.where(nearest, zeros / np.maximum(abs(zeros), 0.5) ** 2 * (1 + OUTSIDE), zeros)
    return np.concatenate([np.poly(moved).real[1:], b])


def with_nuisance(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, jacobian: FloatArray
) -> tuple[FloatArray, int]:
    """∂ε/∂ζ with the directions of a free noise model beside it, and how many parameters that model has."""
    if not isinstance(record, RecordInLoop):
        return jacobian, 0
    nuisance = marginal_errors(structure, zeta, record).nuisance
    return np.concatenate([jacobian, nuisance], axis=1), record.noise_order + len(record.colour)
