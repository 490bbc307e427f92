"""Prediction error estimates of one operating point."""

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from identification.errors import MisuseError, RangeError
from identification.least_squares import levenberg_marquardt
from identification.lti.initial_conditions import errors_from
from identification.lti.prediction_error import PredictionError
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord
from identification.simulation import simulate
from tests.support.plants import EXAMPLE, example_record, random_case, steady_record

OMEGA = np.linspace(0.01, np.pi, 200)
SECOND = RationalStructure(n_a=2, n_b=1, n_k=1, n_c=1, n_d=1, sample_time=1.0)
ZETA = np.array([-1.5, 0.7, 1.0, 0.5, 0.4, -0.8])


def record_of(structure, zeta, seed=0, samples=1000, deviation=0.0, skip=0, u=None):
    g = np.random.default_rng(seed)
    u = g.standard_normal(samples + skip) if u is None else u
    y = simulate(structure, zeta, u, deviation * g.standard_normal(samples + skip))
    return TimeRecord(u[skip:], y[skip:], 1.0, (0.0,))


def response_error(structure, estimate, zeta):
    truth = structure.plant_response(zeta, OMEGA)
    return np.max(abs(structure.plant_response(estimate, OMEGA) - truth)) / np.max(abs(truth))


def reaches_what_truth_reaches(case, initial):
    estimate = PredictionError(initial).estimate(case.structure, case.record)
    found = errors_from(case.structure, estimate.model.zeta, case.record, initial)[0]
    reference = levenberg_marquardt(
        lambda zeta: errors_from(case.structure, zeta, case.record, initial),
        case.zeta,
        lambda zeta: bool(case.structure.stable(zeta)),
        tolerance=1e-7,
    )
    return found @ found <= reference.cost * (1 + 1e-6)


def test_the_search_needs_no_luck():
    cases = [case for case in map(random_case, range(260)) if case is not None]
    assert len(cases) >= 200
    reached = [reaches_what_truth_reaches(case, "zero") for case in cases]
    assert np.mean(reached) >= 0.99


@pytest.mark.parametrize("initial", ["zero", "estimate"])
def test_exact_without_noise(initial):
    structure = RationalStructure(n_a=3, n_b=2, n_k=2, sample_time=1.0)
    zeta = np.concatenate([np.poly([0.9, 0.5 + 0.6j, 0.5 - 0.6j]).real[1:], [1.0, -0.4, 0.2]])
    estimate = PredictionError(initial).estimate(structure, record_of(structure, zeta))
    assert estimate.outcome.ok
    assert response_error(structure, estimate.model.zeta, zeta) < 1e-9
    assert estimate.fit_percent > 99.9999
    assert np.all(np.diag(estimate.model.covariance) > 0)


def test_unknown_initial_state_is_taken_up():
    structure = RationalStructure(n_a=2, n_b=1, n_k=1, sample_time=1.0)
    zeta = np.array([-1.9, 0.95, 1.0, 0.5])
    record = record_of(structure, zeta, skip=50, samples=200)
    free = PredictionError("estimate").estimate(structure, record)
    rest = PredictionError("zero").estimate(structure, record)
    assert response_error(structure, free.model.zeta, zeta) < 1e-9
    assert response_error(structure, rest.model.zeta, zeta) > 1e-3


@pytest.mark.parametrize("poles", [[0.999 * np.exp(0.3j), 0.999 * np.exp(-0.3j)], [0.999], [0.02, -0.03]])
@pytest.mark.parametrize("snr", [100.0, 20.0])
def test_slow_lightly_damped_and_fast_poles(poles, snr):
    structure = RationalStructure(n_a=len(poles), n_b=0, n_k=3, sample_time=1.0)
    zeta = np.concatenate([np.poly(poles).real[1:], [1.0]])
    clean = record_of(structure, zeta, samples=2000)
    noise = np.random.default_rng(1).standard_normal(2000) * np.std(clean.output) * 10 ** (-snr / 20)
    record = TimeRecord(clean.input, clean.output + noise, 1.0, (0.0,))
    estimate = PredictionError("zero").estimate(structure, record)
    assert estimate.outcome.ok
    error = estimate.model.zeta - zeta
    assert error @ np.linalg.solve(estimate.model.covariance, error) < stats.chi2.isf(1e-4, len(zeta))


def test_parameters_noise_variance_and_tests_of_a_true_model():
    estimate = PredictionError("zero").estimate(SECOND, record_of(SECOND, ZETA, deviation=0.7, samples=4000))
    assert abs(estimate.model.noise_variance - 0.49) < 0.05
    error = estimate.model.zeta - ZETA
    assert error @ np.linalg.solve(estimate.model.covariance, error) < stats.chi2.isf(1e-3, 6)
    assert len(estimate.tests) == 2
    assert all(test.p_value > 1e-3 for test in estimate.tests)


def test_a_missing_noise_model_is_not_white_and_a_missing_pole_depends_on_the_input():
    record = record_of(SECOND, ZETA, deviation=0.7)
    white, independent = PredictionError().estimate(RationalStructure(2, 1, 1, sample_time=1.0), record).tests
    assert white.p_value < 1e-6
    assert independent.p_value > 1e-3
    _, independent = PredictionError().estimate(RationalStructure(1, 1, 1, 1, 1, sample_time=1.0), record).tests
    assert independent.p_value < 1e-6


def test_covariance_is_that_of_theory():
    """(7) and (8) evaluated by integration for a white input."""
    samples = 20000
    structure, zeta = EXAMPLE, np.array([-0.6, 7.0, -0.46])
    g = np.random.default_rng(3)
    u, e = g.standard_normal((2, samples))
    record = TimeRecord(u, simulate(structure, zeta, u, np.sqrt(0.5) * e), 1.0, (0.0,))
    model = PredictionError("zero").estimate(structure, record).model
    omega = np.linspace(0, np.pi, 4001)
    noise = structure.noise_response(zeta, omega)
    of_plant = structure.plant_gradient(zeta, omega) / noise
    of_noise = structure.noise_gradient(zeta, omega) / noise
    information = np.zeros((3, 3))
    information[:2, :2] = np.trapezoid((of_plant[:, None] * of_plant[None].conj()).real, omega) / np.pi / 0.5
    information[2:, 2:] = np.trapezoid((of_noise[:, None] * of_noise[None].conj()).real, omega) / np.pi
    expected = np.linalg.inv(samples * information)
    deviations = np.sqrt(np.diag(expected))
    assert np.allclose(np.sqrt(np.diag(model.covariance)), deviations, rtol=0.05)
    assert np.all(abs(model.covariance - expected) < 0.08 * np.outer(deviations, deviations))


def rejections(distances, size):
    low, high = stats.binom.interval(0.99, len(distances), 0.05)
    return low <= np.sum(np.array(distances) > stats.chi2.isf(0.05, size)) <= high


def test_stated_covariance_is_true_and_a_wrong_one_is_caught():
    structure, zeta = RationalStructure(1, 0, 1, 0, 1, sample_time=1.0), np.array([-0.8, 1.0, -0.5])
    distances = []
    for seed in range(500):
        g = np.random.default_rng([7, seed])
        u, e = g.standard_normal((2, 1000))
        record = TimeRecord(u, simulate(structure, zeta, u, 0.5 * e), 1.0, (0.0,))
        model = PredictionError("zero").estimate(structure, record).model
        distances.append((model.zeta - zeta) @ np.linalg.solve(model.covariance, model.zeta - zeta))
    assert rejections(distances, 3)
    assert not rejections(np.array(distances) * 1.3, 3)
    assert not rejections(np.array(distances) / 1.3, 3)


def test_units_of_the_signals_do_not_matter():
    record = record_of(SECOND, ZETA, deviation=0.3)
    scaled = TimeRecord(1e-9 * record.input, 1e50 * record.output, 1.0, (0.0,))
    one, other = PredictionError().estimate(SECOND, record), PredictionError().estimate(SECOND, scaled)
    units = np.array([1, 1, 1e59, 1e59, 1, 1])
    assert np.allclose(other.model.zeta / units, one.model.zeta, rtol=1e-6)
    assert np.allclose(other.model.covariance / np.outer(units, units), one.model.covariance, rtol=1e-4)
    assert np.isclose(other.fit_percent, one.fit_percent)


def test_the_same_record_gives_the_same_estimate():
    record = record_of(SECOND, ZETA, deviation=0.3)
    one, other = (PredictionError().estimate(SECOND, record) for _ in range(2))
    assert np.array_equal(one.model.zeta, other.model.zeta)
    assert np.array_equal(one.model.covariance, other.model.covariance)


@pytest.mark.parametrize("indices", [(0,), (25,)])
def test_too_few_lines_are_not_identifiable(indices):
    structure = RationalStructure(n_a=2, n_b=1, n_k=1, n_d=1, sample_time=1.0)
    estimate = PredictionError("estimate").estimate(structure, steady_record(3.0, indices, np.random.default_rng(0)))
    assert estimate.outcome.status == "not_identifiable"
    assert "excite" in estimate.outcome.advice
    assert np.all(np.isinf(estimate.model.covariance))
    assert np.all(np.isfinite(estimate.model.zeta))


def test_two_lines_are_enough_for_four_coefficients():
    structure = RationalStructure(n_a=2, n_b=1, n_k=1, sample_time=1.0)
    zeta = np.array([-1.5, 0.7, 1.0, 0.5])
    t = np.arange(1200)
    u = np.cos(0.2 * t) + np.cos(0.9 * t)
    estimate = PredictionError().estimate(structure, record_of(structure, zeta, u=u, samples=1200, deviation=0.01))
    assert estimate.outcome.ok
    assert response_error(structure, estimate.model.zeta, zeta) < 0.02


def test_a_record_without_noise_cannot_tell_the_noise_model():
    estimate = PredictionError().estimate(SECOND, record_of(SECOND, ZETA))
    assert estimate.outcome.status == "not_identifiable"
    assert "noise" in estimate.outcome.advice


def test_pure_noise_model_and_pure_gain():
    gain = RationalStructure(0, 0, sample_time=1.0)
    estimate = PredictionError().estimate(gain, record_of(gain, np.array([2.0]), deviation=0.1))
    assert abs(estimate.model.zeta[0] - 2) < 0.02
    noisy = RationalStructure(0, 0, 0, 3, 4, sample_time=1.0)
    zeta = np.concatenate([[2.0], np.poly([0.5, -0.6, 0.2]).real[1:], np.poly([0.9, -0.8, 0.4j, -0.4j]).real[1:]])
    estimate = PredictionError().estimate(noisy, record_of(noisy, zeta, deviation=1.0, samples=4000))
    assert estimate.outcome.ok
    error = estimate.model.zeta - zeta
    assert error @ np.linalg.solve(estimate.model.covariance, error) < stats.chi2.isf(1e-4, 8)


@pytest.mark.parametrize(
    ("u", "y", "named"),
    [
        (np.zeros(50), np.arange(50.0), "input"),
        (np.full(50, 0.1), np.arange(50.0), "operating levels"),
        (np.arange(50.0), np.full(50, 5.3), "output"),
        (np.ones(5), np.ones(5), "samples"),
    ],
)
def test_records_without_information(u, y, named):
    with pytest.raises(MisuseError, match=named):
        PredictionError().estimate(SECOND, TimeRecord(u, y, 1.0, (0.0,)))


def test_signals_beyond_computation():
    record = record_of(SECOND, ZETA, deviation=0.3)
    with pytest.raises(RangeError, match="unit"):
        PredictionError().estimate(SECOND, TimeRecord(1e-150 * record.input, record.output, 1.0, (0.0,)))


def test_misuse():
    record = record_of(EXAMPLE, np.array([-0.5, 1.0, -0.2]), samples=50)
    with pytest.raises(MisuseError, match="frequency response"):
        PredictionError().estimate(RationalStructure(1, 0), record)
    with pytest.raises(MisuseError, match="sample time"):
        PredictionError().estimate(RationalStructure(1, 0, sample_time=0.5), record)
    with pytest.raises(MisuseError, match="zero"):
        PredictionError("rest")  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(5))
def test_much_noise_gives_wide_but_true_bounds(seed):
    g = np.random.default_rng(seed)
    record = example_record(0.0, g, power=1e-4)
    estimate = PredictionError().estimate(EXAMPLE, record)
    assert np.all(np.isfinite(estimate.model.zeta))
    assert bool(EXAMPLE.stable(estimate.model.zeta))


def test_coloured_input():
    u = lfilter([1.0], [1.0, -0.95], np.random.default_rng(0).standard_normal(2000))
    estimate = PredictionError().estimate(SECOND, record_of(SECOND, ZETA, u=u, samples=2000, deviation=0.5))
    error = estimate.model.zeta - ZETA
    assert error @ np.linalg.solve(estimate.model.covariance, error) < stats.chi2.isf(1e-3, 6)
