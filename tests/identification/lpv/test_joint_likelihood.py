"""Parameter-varying models from all experiments at once."""

import numpy as np
import pytest
from scipy import stats

from identification.errors import MisuseError, NotIdentifiableError, TooFewOperatingPointsError
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate
from tests.support.plants import (
    DEPENDENCE,
    EXAMPLE,
    THETA,
    example_record,
    polynomial_dependence,
    steady_record,
    zeta_of_example,
)

POINTS = (0.0, 3.0, 5.5, 8.0)
GRID = np.linspace(0, 8, 9)[:, None]
OMEGA = np.linspace(0.01, 3, 50)
LINES = {0.0: (16,), 1.5: (0,), 8.0: (180, 218)}


def distance(model, theta=THETA):
    return (model.theta - theta) @ np.linalg.solve(model.covariance, model.theta - theta)


def response_at(p, structure, zeta, omega, generator=None, deviation=0.1, known=True):
    noise = 0.0
    if generator is not None:
        noise = deviation * (generator.standard_normal((2, len(omega))).T @ [1, 1j]) / np.sqrt(2)
    variance = np.full(len(omega), deviation**2) if known else None
    return FrequencyResponse(
        omega, structure.plant_response(zeta, omega) + noise, (p,), structure.sample_time, variance
    )


def largest_error(model, theta=THETA):
    truth = Model(model.structure, model.dependence, theta, model.covariance, 1.0).frequency_response(GRID, OMEGA)
    return np.max(abs(model.frequency_response(GRID, OMEGA) / truth - 1))


def test_agrees_with_two_steps_where_both_are_defined():
    g = np.random.default_rng(0)
    records = [example_record(p, g, samples=4000) for p in POINTS]
    local = [PredictionError("zero").estimate(EXAMPLE, record) for record in records]
    two_step = GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, records, local).model
    joint = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, records, local)
    assert joint.outcome.ok
    difference = joint.model.theta - two_step.theta
    assert difference @ np.linalg.solve(joint.model.covariance, difference) < 0.3
    assert np.allclose(np.diag(joint.model.covariance), np.diag(two_step.covariance), rtol=0.1)
    assert np.isclose(joint.model.noise_variance, two_step.noise_variance, rtol=0.01)


def test_the_start_does_not_matter():
    g = np.random.default_rng(1)
    records = [example_record(p, g) for p in POINTS]
    local = [PredictionError("zero").estimate(EXAMPLE, record) for record in records]
    with_local = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, records, local).model
    without = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, records).model
    assert np.allclose(without.theta, with_local.theta, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("with_local", [True, False])
def test_single_lines_where_no_local_model_exists(with_local):
    distances = []
    for seed in range(12):
        g = np.random.default_rng(seed)
        records = [steady_record(p, lines, g) for p, lines in LINES.items()]
        local = [PredictionError().estimate(EXAMPLE, record) for record in records] if with_local else []
        estimate = JointLikelihood().estimate(EXAMPLE, DEPENDENCE, records, local)
        assert estimate.outcome.ok
        distances.append(distance(estimate.model))
    assert stats.chi2.cdf(sum(distances), 6 * 12) < 0.999


def test_lines_at_too_few_places_are_not_identifiable():
    g = np.random.default_rng(0)
    records = [steady_record(p, (0,), g) for p in (0.0, 4.0, 8.0)]
    estimate = JointLikelihood().estimate(EXAMPLE, DEPENDENCE, records)
    assert estimate.outcome.status == "not_identifiable"
    assert np.all(np.isinf(estimate.model.covariance))
    assert estimate.tests == ()


def test_records_and_responses_together():
    g = np.random.default_rng(2)
    records = [example_record(p, g) for p in (0.0, 8.0)]
    omega = np.linspace(0.05, 2.5, 40)
    response = response_at(4.0, EXAMPLE, zeta_of_example(4.0), omega, g, 0.02)
    alone = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, records).model
    both = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, [*records, response])
    assert distance(both.model) < stats.chi2.isf(1e-3, 6)
    assert both.model.covariance[1, 1] < 0.9 * alone.covariance[1, 1]
    fit = next(test for test in both.tests if test.name == "lack of fit, p = 4")
    assert 70 < fit.degrees_of_freedom < 80
    assert fit.p_value > 1e-3


def test_responses_alone_in_continuous_time():
    structure = RationalStructure(n_a=2, n_b=0)
    dependence = polynomial_dependence(1, 1, 0)
    theta = np.array([0.3, 0.1, 1.0, 0.5, 2.0])
    omega = np.logspace(-1, 1, 40)
    zeta = [(dependence.matrix([[p]]) @ theta)[0] for p in (0.0, 4.0, 8.0)]
    exact = [response_at(p, structure, z, omega) for p, z in zip((0.0, 4.0, 8.0), zeta, strict=True)]
    estimate = JointLikelihood().estimate(structure, dependence, exact)
    assert estimate.outcome.ok
    assert largest_error(estimate.model, theta) < 1e-8
    g = np.random.default_rng(0)
    noisy = [response_at(p, structure, z, omega, g, 0.05, False) for p, z in zip((0.0, 4.0, 8.0), zeta, strict=True)]
    estimate = JointLikelihood().estimate(structure, dependence, noisy)
    assert distance(estimate.model, theta) < stats.chi2.isf(1e-3, 5)
    assert 0.7 < estimate.model.noise_variance / 0.05**2 < 1.4


def test_a_delay_that_varies():
    structure = RationalStructure(n_a=1, n_b=0, delay=True)
    dependence = polynomial_dependence(1, 0, 1)
    theta = np.array([1.0, 0.2, 2.0, 0.3, 0.02])
    omega = np.linspace(0.1, 6, 60)
    data = [
        response_at(p, structure, (dependence.matrix([[p]]) @ theta)[0], omega, np.random.default_rng(int(p)), 0.01)
        for p in (0.0, 4.0, 8.0)
    ]
    estimate = JointLikelihood().estimate(structure, dependence, data)
    assert estimate.outcome.ok
    assert distance(estimate.model, theta) < stats.chi2.isf(1e-3, 5)


def test_one_noise_variance_or_one_for_each():
    g = np.random.default_rng(3)
    records = [example_record(p, g, noise=0.05 if p < 4 else 5.0) for p in POINTS]
    common = JointLikelihood("zero").estimate(EXAMPLE, DEPENDENCE, records).model
    each = JointLikelihood("zero", "per_experiment").estimate(EXAMPLE, DEPENDENCE, records).model
    assert distance(each) < stats.chi2.isf(1e-3, 6)
    assert np.linalg.slogdet(each.covariance)[1] < np.linalg.slogdet(common.covariance)[1] - 2
    assert np.isclose(each.noise_variance, np.mean([0.05, 0.05, 5.0, 5.0]), rtol=0.1)


def test_prior_stands_for_the_experiments_it_came_from():
    g = np.random.default_rng(4)
    records = [example_record(p, g, samples=4000) for p in (0.0, 3.0, 8.0, 1.5)]
    estimator = JointLikelihood("zero")
    whole = estimator.estimate(EXAMPLE, DEPENDENCE, records).model
    first = estimator.estimate(EXAMPLE, DEPENDENCE, records[:3]).model
    second = estimator.estimate(EXAMPLE, DEPENDENCE, records[3:], prior=first).model
    difference = second.theta - whole.theta
    assert difference @ np.linalg.solve(whole.covariance, difference) < 0.05
    assert np.allclose(np.diag(second.covariance), np.diag(whole.covariance), rtol=0.05)
    assert not np.allclose(first.theta, whole.theta, rtol=1e-6)


def test_too_low_an_order_is_seen():
    g = np.random.default_rng(5)
    records = [example_record(p, g) for p in POINTS]
    estimator = JointLikelihood("zero")
    right = estimator.estimate(EXAMPLE, DEPENDENCE, records).tests
    wrong = estimator.estimate(EXAMPLE, polynomial_dependence(1, 0, 1), records).tests
    assert right[0].name == wrong[0].name == "dependence on the operating point"
    assert right[0].degrees_of_freedom == 12 - 6
    assert right[0].p_value > 1e-3
    assert wrong[0].p_value < 1e-6
    assert {test.name for test in right[1:]} >= {"whiteness of the prediction errors, p = 3"}
    assert all(test.p_value > 1e-4 for test in right)


def test_covariances_of_two_steps_and_of_one_are_true():
    structure = RationalStructure(1, 0, 1, sample_time=1.0)
    dependence = polynomial_dependence(1, 1)
    theta = np.array([-0.8, 0.1, 2.0, -0.2])
    two_step, joint = [], []
    for seed in range(250):
        g = np.random.default_rng([9, seed])
        records = []
        for p in (0.0, 4.0, 8.0):
            u, e = g.standard_normal((2, 500))
            records.append(TimeRecord(u, simulate(structure, (dependence.matrix([[p]]) @ theta)[0], u, e), 1.0, (p,)))
        local = [PredictionError("zero").estimate(structure, record) for record in records]
        first = GeneralisedLeastSquares().estimate(structure, dependence, records, local).model
        two_step.append(distance(first, theta))
        joint.append(distance(JointLikelihood("zero").estimate(structure, dependence, records, local).model, theta))
    low, high = stats.binom.interval(0.99, 250, 0.05)
    for distances in (np.array(two_step), np.array(joint)):
        assert low <= np.sum(distances > stats.chi2.isf(0.05, 4)) <= high
        assert np.sum(1.3 * distances > stats.chi2.isf(0.05, 4)) > high


def test_misuse():
    g = np.random.default_rng(0)
    responses = [response_at(p, EXAMPLE, zeta_of_example(p), OMEGA, g) for p in POINTS]
    estimator = JointLikelihood()
    with pytest.raises(NotIdentifiableError, match="n_c = n_d = 0"):
        estimator.estimate(EXAMPLE, DEPENDENCE, responses)
    with pytest.raises(NotIdentifiableError, match="1 time records"):
        estimator.estimate(EXAMPLE, DEPENDENCE, [example_record(0.0, g), *responses])
    with pytest.raises(TooFewOperatingPointsError, match="at least 2"):
        estimator.estimate(EXAMPLE, DEPENDENCE, [example_record(0.0, g)])
    zeros = [TimeRecord(np.ones(50), np.zeros(50), 1.0, (p,)) for p in POINTS]
    with pytest.raises(NotIdentifiableError, match="zero throughout"):
        estimator.estimate(EXAMPLE, DEPENDENCE, zeros)
    with pytest.raises(NotIdentifiableError, match="cannot determine"):
        estimator.estimate(EXAMPLE, DEPENDENCE, [example_record(p, g, samples=3) for p in (0.0, 8.0)])
    with pytest.raises(MisuseError, match="sample time"):
        estimator.estimate(EXAMPLE, DEPENDENCE, [TimeRecord([1, 2], [1, 2], 0.1, (p,)) for p in POINTS])
    for options in (("rest",), ("zero", "own"), ("zero", "common", "none")):
        with pytest.raises(MisuseError):
            JointLikelihood(*options)  # type: ignore[arg-type]
