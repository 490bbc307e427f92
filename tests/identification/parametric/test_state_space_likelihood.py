"""Maximum likelihood of parametric state-space models: exact gradient, true covariance, nothing tied to the basis."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError, NotIdentifiableError
from identification.models.chart import gauge_tangent
from identification.models.state_space_model import stacks, state_space_model
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.parametric.state_space_likelihood import StateSpaceLikelihood
from identification.parametric.state_space_residuals import residual_and_jacobian, whitener
from identification.pole_regions.disc import Disc
from identification.signals import FrequencyResponse
from tests.support.parametric import AFFINE, canonical_plant, dense_plant, dependence, example_data, responses

OMEGA = np.linspace(0.05, 6.2, 60)
POINTS = [(0.0,), (0.4,), (0.7,), (1.0,)]
DEPENDS = dependence(1, 1, 0, 1)
PLANT = dense_plant(np.random.default_rng(2), DEPENDS, 0.5)


def noisy(seed, level=0.05):
    return responses(PLANT, POINTS, OMEGA, np.random.default_rng(seed), level, variances=True)


def started(data):
    g = np.random.default_rng(len(data))
    return replace(PLANT, theta=PLANT.theta * (1 + 0.02 * g.standard_normal(len(PLANT.theta))))


def test_the_gradient_is_that_of_the_residual():
    g = np.random.default_rng(0)
    data = noisy(1)
    root = g.standard_normal((4, 4)) + 1j * g.standard_normal((4, 4))
    covariance = np.broadcast_to(root @ root.conj().T + np.eye(4), (len(OMEGA), 4, 4))
    data[1] = FrequencyResponse(OMEGA, data[1].response, POINTS[1], 0.5, covariance=covariance)
    weights, theta = [whitener(d) for d in data], PLANT.theta
    jacobian = residual_and_jacobian(PLANT, data, weights)[1]
    for direction in g.standard_normal((5, len(theta))):
        step = 1e-6 * direction
        plus, minus = (residual_and_jacobian(replace(PLANT, theta=theta + s), data, weights)[0] for s in (step, -step))
        assert np.allclose((plus - minus) / 2, jacobian @ step, atol=1e-9 * abs(jacobian @ step).max() + 1e-11)
    idle = jacobian @ gauge_tangent(PLANT.structure, PLANT.dependence, theta)
    assert abs(idle).max() < 1e-10 * abs(jacobian).max()


def test_whitened_noise_has_unit_covariance():
    g = np.random.default_rng(1)
    root = g.standard_normal((4, 4)) + 1j * g.standard_normal((4, 4))
    covariance = np.broadcast_to(root @ root.conj().T, (3, 4, 4))
    data = FrequencyResponse(OMEGA[:3], np.ones((3, 2, 2)) + 0j, (0.0,), 0.5, covariance=covariance)
    weight = whitener(data)
    assert np.allclose(weight @ covariance @ np.conj(np.swapaxes(weight, 1, 2)), np.eye(4))


def test_the_covariance_is_that_of_the_estimates():
    """Over 30 records: squared errors of the response against their predicted covariance, and the fit against χ²."""
    omega, point = np.array([0.3, 1.5, 3.0, 5.0]), [[0.25]]
    truth = PLANT.frequency_response(point, omega)
    distances, fits = [], []
    for seed in range(30):
        data = noisy(seed)
        found = StateSpaceLikelihood().estimate(started(data), data)
        assert found.outcome.ok
        error = (found.model.frequency_response(point, omega) - truth)[0]
        pair = np.stack([error.real, error.imag], axis=-1)
        covariance = found.model.response_covariance(point, omega)[0]
        distances.append(np.einsum("fyui,fyuij,fyuj->fyu", pair, np.linalg.inv(covariance), pair).mean())
        fits.append(found.tests[0].p_value)
    assert 1.6 < np.mean(distances) < 2.4
    assert 0.3 < np.mean(fits) < 0.7
    assert min(fits) > 1e-4


def test_it_is_better_than_its_start():
    data = noisy(3, level=0.2)
    start = started(data)
    weights = [whitener(d) for d in data]
    found = StateSpaceLikelihood().estimate(start, data).model
    costs = [np.sum(residual_and_jacobian(m, data, weights)[0] ** 2) for m in (start, found, PLANT)]
    assert costs[1] < costs[0]
    assert costs[1] < costs[2]


def test_the_basis_of_the_state_does_not_matter():
    data = noisy(5)
    start = started(data)
    turn = np.random.default_rng(0).standard_normal((3, 3))
    back = np.linalg.inv(turn)
    a, b, c, d = stacks(start)
    turned = state_space_model(start.variables, start.dependence.bases, (back @ a @ turn, back @ b, c @ turn, d), 0.5)
    one, other = (StateSpaceLikelihood().estimate(s, data) for s in (start, turned))
    responses_of = [e.model.frequency_response([[0.6]], OMEGA) for e in (one, other)]
    covariances = [e.model.response_covariance([[0.6]], OMEGA) for e in (one, other)]
    deviations = np.sqrt(np.trace(covariances[0], axis1=-2, axis2=-1))
    assert (abs(responses_of[0] - responses_of[1]) / deviations).max() < 0.02
    assert np.allclose(*covariances, rtol=0, atol=0.05 * deviations.max() ** 2)


def test_unknown_variances_are_estimated():
    data = responses(PLANT, POINTS, OMEGA, np.random.default_rng(8), 0.05)
    known = responses(PLANT, POINTS, OMEGA, np.random.default_rng(8), 0.05, variances=True)
    found = StateSpaceLikelihood().estimate(started(data), data)
    assert found.tests == ()
    assert found.model.noise_variance == pytest.approx(np.mean([d.variance[0, 0, 0] for d in known]), rel=0.3)


def test_poles_stay_in_the_region():
    everywhere = np.linspace(0, 1, 1001)[:, None]
    left = 0
    for seed in range(6):
        data = example_data(np.random.default_rng(seed))
        start = ParametricSubspace(2, 10, region=Disc()).estimate(AFFINE, data).model
        kept = StateSpaceLikelihood(region=Disc()).estimate(start, data).model
        left += not StateSpaceLikelihood().estimate(start, data).model.stable(everywhere).all()
        assert kept.stable(np.linspace(0, 1, 65)[:, None]).all()
    assert left > 0


def test_too_few_operating_points_are_noticed():
    """Two operating points leave open how the state basis turns in between."""
    plant = canonical_plant(np.random.default_rng(4), (3,), 1, AFFINE, 0.5)
    two = responses(plant, [(0.0,), (1.0,)], OMEGA, np.random.default_rng(1), 0.02, variances=True)
    found = StateSpaceLikelihood().estimate(plant, two)
    assert found.outcome.status == "not_identifiable"
    assert "more of them" in found.outcome.advice


def test_misuse_is_named():
    data = noisy(1)
    with pytest.raises(NotIdentifiableError, match="fewer than the model"):
        StateSpaceLikelihood().estimate(PLANT, [d.lines(slice(0, 1)) for d in data])
    with pytest.raises(MisuseError, match="must agree"):
        StateSpaceLikelihood().estimate(PLANT, example_data())
    with pytest.raises(MisuseError, match="outside the region"):
        StateSpaceLikelihood(region=Disc(0.1)).estimate(PLANT, data)
