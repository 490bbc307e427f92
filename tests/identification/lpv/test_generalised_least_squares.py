"""Parameter-varying models from local models [Ghosh2018, Theorem 1]."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from identification.bases.b_spline import BSpline
from identification.errors import MisuseError, NotIdentifiableError, ShapeError, TooFewOperatingPointsError
from identification.estimates import LocalEstimate
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lti.prediction_error import PredictionError
from identification.models.model import LocalModel, Model
from identification.outcome import Outcome
from identification.scheduling import ParameterDependence, ProductBasis
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.plants import (
    DEPENDENCE,
    EXAMPLE,
    THETA,
    P,
    example_record,
    polynomial_dependence,
    steady_record,
    zeta_of_example,
)

POINTS = (0.0, 3.0, 5.5, 8.0)
GRID = np.linspace(0, 8, 9)[:, None]
OMEGA = np.linspace(0.01, 3, 50)


def covariance_at(generator):
    root = generator.standard_normal((3, 3)) * [[0.01], [0.1], [0.03]]
    return root @ root.T + 1e-6 * np.eye(3)


def local_at(p, generator, covariance=None, deviation=1.0):
    covariance = covariance_at(generator) if covariance is None else covariance
    zeta = zeta_of_example(p) + deviation * np.linalg.cholesky(covariance) @ generator.standard_normal(3)
    return LocalEstimate(LocalModel(EXAMPLE, (p,), zeta, covariance, 0.5), Outcome("converged"), (), 99.0)


def record_at(p, samples=1000):
    return TimeRecord(np.ones(samples), np.ones(samples), 1.0, (p,))


def fitted(points, seed=0, deviation=1.0, dependence=DEPENDENCE, prior=None):
    g = np.random.default_rng(seed)
    local = [local_at(p, g, deviation=deviation) for p in points]
    experiments = [record_at(p) for p in points]
    return GeneralisedLeastSquares().estimate(EXAMPLE, dependence, experiments, local, prior)


def test_the_estimate_is_nine_and_ten():
    estimate = fitted(POINTS)
    T = DEPENDENCE.matrix([[p] for p in POINTS])
    weights = [np.linalg.inv(each.model.covariance) for each in estimate.local]
    information = sum(t.T @ w @ t for t, w in zip(T, weights, strict=True))
    right = sum(t.T @ w @ each.model.zeta for t, w, each in zip(T, weights, estimate.local, strict=True))
    assert np.allclose(estimate.model.theta, np.linalg.solve(information, right), rtol=1e-6)
    assert np.allclose(estimate.model.covariance, np.linalg.inv(information), rtol=1e-5)
    assert estimate.model.noise_variance == 0.5


def test_exact_for_exact_local_models():
    estimate = fitted((0.0, 8.0), deviation=0.0)
    truth = Model(EXAMPLE, DEPENDENCE, THETA, np.eye(6), 0.5)
    assert np.allclose(estimate.model.frequency_response(GRID, OMEGA), truth.frequency_response(GRID, OMEGA), rtol=1e-9)


def test_covariance_is_true_and_the_tests_hold_their_level():
    distances, levels = [], {}
    for seed in range(600):
        estimate = fitted(POINTS, seed)
        error = estimate.model.theta - THETA
        distances.append(error @ np.linalg.solve(estimate.model.covariance, error))
        for test in estimate.tests:
            levels.setdefault(test.name, []).append(test.p_value)
    low, high = stats.binom.interval(0.999, 600, 0.05)
    assert low <= np.sum(np.array(distances) > stats.chi2.isf(0.05, 6)) <= high
    assert np.sum(1.3 * np.array(distances) > stats.chi2.isf(0.05, 6)) > high
    assert {"dependence on the operating point", "dependence of a1 on the operating point"} <= set(levels)
    assert "agreement of p = 3 with the others" in levels
    for values in levels.values():
        assert low <= np.sum(np.array(values) < 0.05) <= high


def test_degrees_of_freedom():
    tests = {test.name: test for test in fitted(POINTS).tests}
    assert tests["dependence on the operating point"].degrees_of_freedom == 3 * 4 - 6
    assert tests["dependence of b0 on the operating point"].degrees_of_freedom == 4 - 2
    assert tests["agreement of p = 0 with the others"].degrees_of_freedom == 3
    (only,) = fitted((0.0, 8.0)).tests
    assert (only.degrees_of_freedom, only.p_value) == (0.0, 1.0)


def test_too_low_an_order_is_seen_and_named():
    estimate = fitted(POINTS, dependence=polynomial_dependence(1, 0, 1))
    p_values = {test.name: test.p_value for test in estimate.tests}
    assert p_values["dependence on the operating point"] < 1e-6
    assert p_values["dependence of b0 on the operating point"] < 1e-6
    assert p_values["dependence of a1 on the operating point"] > 1e-3


def test_an_outlying_operating_point_is_named():
    g = np.random.default_rng(4)
    local = [local_at(p, g) for p in POINTS]
    moved = local[1].model.zeta + 8 * np.sqrt(np.diag(local[1].model.covariance))
    local[1] = replace(local[1], model=replace(local[1].model, zeta=moved))
    experiments = [record_at(p) for p in POINTS]
    estimate = GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, experiments, local)
    p_values = {test.name: test.p_value for test in estimate.tests if test.name.startswith("agreement")}
    assert min(p_values, key=p_values.get) == "agreement of p = 3 with the others"


def test_two_stages_are_as_good_as_one():
    """(13): combining with the estimate of the first experiments is the estimate from all of them."""
    g = np.random.default_rng(5)
    local = [local_at(p, g) for p in (0.0, 3.0, 8.0, 1.5)]
    experiments = [record_at(each.model.operating_point[0]) for each in local]
    estimator = GeneralisedLeastSquares()
    whole = estimator.estimate(EXAMPLE, DEPENDENCE, experiments, local).model
    first = estimator.estimate(EXAMPLE, DEPENDENCE, experiments[:3], local[:3]).model
    second = estimator.estimate(EXAMPLE, DEPENDENCE, experiments[3:], local[3:], prior=first).model
    assert np.allclose(second.theta, whole.theta, rtol=1e-8)
    assert np.allclose(second.covariance, whole.covariance, rtol=1e-6)


def test_too_few_operating_points_says_how_many_are_needed():
    assert polynomial_dependence(1, 3, 0).needed_operating_points == 4
    with pytest.raises(TooFewOperatingPointsError, match="at least 2") as raised:
        fitted((3.0, 3.0, 3.0))
    assert (raised.value.needed, raised.value.given) == (2, 1)


def test_basis_functions_that_are_not_unisolvent():
    """Remark 2: enough operating points, but all under the same splines."""
    spline = ProductBasis((BSpline(1, (2.0, 4.0, 6.0)),))
    dependence = ParameterDependence((P,), (spline, spline, spline))
    with pytest.raises(TooFewOperatingPointsError, match="placed"):
        fitted((0.0, 0.4, 0.8, 1.2, 1.6, 2.0), dependence=dependence)
    assert fitted((0.0, 2.0, 4.0, 6.0, 8.0), dependence=dependence).outcome.ok


def test_a_local_model_that_does_not_exist_is_named():
    g = np.random.default_rng(0)
    records = [example_record(0.0, g), steady_record(1.5, (0,), g), example_record(8.0, g)]
    local = [PredictionError().estimate(EXAMPLE, record) for record in records]
    with pytest.raises(NotIdentifiableError, match=r"p = 1\.5.*joint likelihood"):
        GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, records, local)


def test_a_singular_covariance_is_named():
    g = np.random.default_rng(0)
    local = [local_at(0.0, g), local_at(8.0, g)]
    local[1] = replace(local[1], model=replace(local[1].model, covariance=np.diag([1e-4, 0.0, 1e-4])))
    with pytest.raises(NotIdentifiableError, match="p = 8"):
        GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, [record_at(0.0), record_at(8.0)], local)


def test_a_short_record_is_warned_of_and_an_unstable_model_refused():
    g = np.random.default_rng(1)
    local = [local_at(p, g) for p in POINTS]
    experiments = [record_at(p, 40 if p == 3.0 else 1000) for p in POINTS]
    outcome = GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, experiments, local).outcome
    assert outcome.ok
    assert "p = 3 has only 40" in outcome.advice
    zeta = np.array([-1.2, 10.0, -0.7])
    local[0] = replace(local[0], model=replace(local[0].model, zeta=zeta, covariance=1e-8 * np.eye(3)))
    outcome = GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, experiments, local).outcome
    assert outcome.status == "infeasible"
    assert "unstable at p = 0" in outcome.advice


def test_misuse():
    g = np.random.default_rng(1)
    local = [local_at(p, g) for p in POINTS]
    experiments = [record_at(p) for p in POINTS]
    estimator = GeneralisedLeastSquares()
    with pytest.raises(ShapeError, match="one each"):
        estimator.estimate(EXAMPLE, DEPENDENCE, experiments, local[:3])
    with pytest.raises(MisuseError, match="p = 0"):
        estimator.estimate(EXAMPLE, DEPENDENCE, experiments, local[::-1])
    with pytest.raises(MisuseError, match="no experiment"):
        estimator.estimate(EXAMPLE, DEPENDENCE, [], [])
    with pytest.raises(ShapeError, match="bases"):
        estimator.estimate(EXAMPLE, polynomial_dependence(1, 1), experiments, local)
    responses = [FrequencyResponse([0.1], [1.0], (p,), 1.0) for p in POINTS]
    with pytest.raises(NotIdentifiableError, match="says nothing about H"):
        estimator.estimate(EXAMPLE, DEPENDENCE, responses, local)
    other = Model(EXAMPLE, polynomial_dependence(0, 0, 0), np.zeros(3), np.eye(3), 1.0)
    with pytest.raises(MisuseError, match="prior"):
        estimator.estimate(EXAMPLE, DEPENDENCE, experiments, local, prior=other)


def test_units_lose_no_digits():
    """Coefficients of very different size, as in continuous time far from 1 rad/s."""
    g = np.random.default_rng(2)
    scale = np.array([1e-9, 1e12, 1.0])
    local = [local_at(p, g) for p in POINTS]
    scaled = [
        replace(
            e, model=replace(e.model, zeta=scale * e.model.zeta, covariance=e.model.covariance * np.outer(scale, scale))
        )
        for e in local
    ]
    experiments = [record_at(p) for p in POINTS]
    one, other = (
        GeneralisedLeastSquares().estimate(EXAMPLE, DEPENDENCE, experiments, e).model for e in (local, scaled)
    )
    assert np.allclose(other.theta / np.repeat(scale, 2), one.theta, rtol=1e-9)
