"""Models that relax: real poles with positive residues, as of resistors and RC arcs in series."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.least_squares import LeastSquaresSolution, levenberg_marquardt
from identification.lti.likelihood import response_errors
from identification.models.rational import RationalStructure
from identification.outcome import Outcome
from identification.signals import FrequencyResponse

GRID = 30
BEAM = 4
FURTHEST = np.log(1e12)


def require_relaxation(structure: RationalStructure) -> None:
    """Raises MisuseError unless the structure can be written with real poles and positive residues."""
    if structure.is_discrete or structure.delay or structure.n_b - structure.n_a not in (-1, 0, 1):
        raise MisuseError(
            "a model with positive residues is in continuous time, without delay, with n_b one less than n_a, equal to"
            " it (a resistor in series) or one more (an inductance as well)",
            "structure",
        )


def relaxation_fit(
    structure: RationalStructure, data: FrequencyResponse, weights: FloatArray, iterations: int
) -> LeastSquaresSolution:
    """The best fit of a series of arcs, resistor and inductance, with positive elements, as a solution in ζ.

        G = Σ_i r_i/(x + p_i) + R + L x,   p_i, r_i, R, L > 0;   R for n_b ≥ n_a, L for n_b = n_a + 1

    Poles are first chosen from a logarithmic grid, one more at a time, with r, R, L from non-negative least squares;
    the logarithms of all elements are then free.
    """
    x = np.asarray(1j * data.frequencies / structure.frequency_scale)
    solutions = [_search(structure, data, weights, start, iterations) for start in _starts(structure, x, data, weights)]
    best = min(solutions, key=lambda solution: solution.cost)
    zeta = _as_zeta(structure, np.exp(best.x))
    residual, jacobian = response_errors(structure, zeta, data, weights)
    return LeastSquaresSolution(zeta, residual, jacobian, _outcome(best.outcome))


def _outcome(outcome: Outcome) -> Outcome:
    if outcome.ok:
        return outcome
    advice = f"{outcome.advice}; an element may want to be zero or negative: choose fewer arcs, or allow any residues"
    return Outcome(outcome.status, advice, outcome.iterations)


def _search(
    structure: RationalStructure, data: FrequencyResponse, weights: FloatArray, start: FloatArray, iterations: int
) -> LeastSquaresSolution:
    x, n = np.asarray(1j * data.frequencies / structure.frequency_scale), structure.n_a

    def evaluate(logarithms: FloatArray) -> tuple[FloatArray, FloatArray]:
        elements = np.exp(logarithms)
        columns = _columns(structure, x, elements[:n])
        by_pole = -elements[n : 2 * n] * columns[:, :n] ** 2
        gradient = np.concatenate([by_pole, columns], axis=1) * elements
        error = data.response - columns @ elements[n:]
        weight = np.sqrt(2) * weights
        return _parts(weight * error), -_parts(weight[:, None] * gradient)

    def near(logarithms: FloatArray) -> bool:
        return bool(np.all(abs(logarithms - np.log(start)) < FURTHEST))

    return levenberg_marquardt(evaluate, np.log(start), near, iterations)


def _starts(
    structure: RationalStructure, x: ComplexArray, data: FrequencyResponse, weights: FloatArray
) -> list[FloatArray]:
    """Elements (p, r, R, L) to start from: the best few sets of poles, grown one pole at a time."""
    positive = abs(x[abs(x) > 0])
    grid = np.geomspace(positive.min(), positive.max(), GRID) if len(positive) else np.ones(1)
    sets: list[tuple[float, ...]] = [()]
    for _ in range(structure.n_a):
        longer = {tuple(sorted((*poles, float(p)))) for poles in sets for p in grid if p not in poles}
        sets = sorted(longer, key=lambda poles: _amplitudes(structure, x, data, weights, poles)[1])[:BEAM]
    starts = []
    for poles in sets:
        amplitudes = _amplitudes(structure, x, data, weights, poles)[0]
        floor = 1e-3 * amplitudes[amplitudes > 0].min(initial=abs(data.response).max())
        starts.append(np.concatenate([poles, np.maximum(amplitudes, floor)]))
    return starts


def _amplitudes(
    structure: RationalStructure,
    x: ComplexArray,
    data: FrequencyResponse,
    weights: FloatArray,
    poles: tuple[float, ...],
) -> tuple[FloatArray, float]:
    """(r, R, L) ≥ 0 for given poles by non-negative least squares, and the cost."""
    from scipy.optimize import nnls  # slow to load, and describing models needs none of it

    columns = _parts(weights[:, None] * _columns(structure, x, np.array(poles)))
    lengths = np.linalg.norm(columns, axis=0)
    amplitudes, cost = nnls(columns / lengths, _parts(weights * data.response))
    return amplitudes / lengths, float(cost)


def _columns(structure: RationalStructure, x: ComplexArray, poles: FloatArray) -> ComplexArray:
    """The responses (F, …) that the amplitudes r, R, L multiply."""
    extra = np.stack([np.ones_like(x), x], axis=1)[:, : structure.n_b - structure.n_a + 1]
    return np.concatenate([1 / (x[:, None] + poles), extra], axis=1)


def _parts(values: ComplexArray) -> FloatArray:
    return np.concatenate([values.real, values.imag])


def _as_zeta(structure: RationalStructure, elements: FloatArray) -> FloatArray:
    n = structure.n_a
    poles, residues, extra = elements[:n], elements[n : 2 * n], elements[2 * n :]
    denominator = np.atleast_1d(np.poly(-poles))
    numerator = np.convolve(extra[::-1], denominator) if len(extra) else np.zeros(n)
    for i, residue in enumerate(residues):
        part = residue * np.atleast_1d(np.poly(-np.delete(poles, i)))
        numerator[len(numerator) - n :] += part
    return np.concatenate([denominator[1:], numerator])
