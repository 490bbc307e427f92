"""The time-domain likelihood: its gradient, its minimum, and the covariance that it states."""

import numpy as np
import pytest

from identification.errors import NotIdentifiableError, ShapeError
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace
from identification.varying.output_error import _Problem, output_error
from identification.varying.records import VaryingRecord
from tests.support.random_state_space import random_affine, white_record


def perturbed(model, rng, size):
    sizes = AffineSizes.of(model)
    theta = sizes.join((model.a, model.b, model.c, model.d))
    return sizes.model(theta + size * rng.standard_normal(sizes.size), 1.0)


def test_the_gradient_is_that_of_the_cost():
    rng = np.random.default_rng(0)
    model, _ = random_affine(rng, 3, 2, 2, 2)
    record = white_record(model, rng, 80, 10.0)
    noise = np.array([[1.0, 0.3], [0.3, 2.0]])
    initial = rng.standard_normal(3)
    problem = _Problem(model, initial, record, noise, np.full(2, 1e-20))

    def cost(beta):
        errors = record.output - AffineStateSpace(*problem.matrices(beta), 1.0).simulate(
            record.input, record.scheduling, problem.state(beta)
        )
        prior = np.sum((problem.state(beta) / problem.spread) ** 2)
        return float(np.sum(errors @ np.linalg.inv(noise) * errors) + prior)

    beta, step = (0.02 * rng.standard_normal(problem.size) for _ in range(2))
    residual, jacobian = problem.evaluate(beta)
    assert residual @ residual == pytest.approx(cost(beta), rel=1e-10)
    slope = (cost(beta + 1e-5 * step) - cost(beta - 1e-5 * step)) / 2e-5
    assert 2 * residual @ jacobian @ step == pytest.approx(slope, rel=1e-5)
    assert np.linalg.matrix_rank(jacobian) == problem.size


def test_noise_free_data_give_the_model_back():
    rng = np.random.default_rng(1)
    model, _ = random_affine(rng, 2, 2, 2, 2)
    record = white_record(model, rng, 400, np.inf)
    found = output_error(perturbed(model, rng, 0.03), record)
    assert found.outcome.ok
    assert np.linalg.norm(found.errors) < 1e-9 * np.linalg.norm(record.output)


def test_a_record_may_begin_in_any_state():
    rng = np.random.default_rng(5)
    model, _ = random_affine(rng, 2, 2, 2, 2)
    whole = white_record(model, rng, 700, 30.0)
    record = whole.part(200, 600)
    found = output_error(perturbed(model, rng, 0.03), record)
    noise = whole.output - model.simulate(whole.input, whole.scheduling)
    assert found.outcome.ok
    assert np.mean(found.errors[:5] ** 2) < 3 * np.mean(noise**2)
    assert np.trace(found.noise_covariance) == pytest.approx(np.sum(np.mean(noise**2, axis=0)), rel=0.15)


def test_the_stated_covariance_is_that_of_the_responses():
    rng = np.random.default_rng(2)
    model, _ = random_affine(rng, 1, 1, 1, 2, contraction=0.7)
    u, p = rng.standard_normal((12, 1)), rng.uniform(-1, 1, (12, 1))
    truth, distances, noise = model.simulate(u, p), [], []
    for _ in range(80):
        record = white_record(model, rng, 300, 10.0)
        found = output_error(perturbed(model, rng, 0.02), record)
        error = (found.model.simulate(u, p) - truth)[:, 0]
        distances.append(error**2 / found.output_covariance(u, p)[:, 0, 0])
        noise.append(np.trace(found.noise_covariance) / np.trace(np.diag(np.mean(record.output**2, axis=0))))
        assert found.outcome.ok
    ratio = np.mean(distances)
    assert 0.75 < ratio < 1.3, ratio
    assert np.mean(noise) == pytest.approx(0.1 / 1.1 * (1 - 7 / 600), rel=0.03)


def test_sizes_that_do_not_fit():
    rng = np.random.default_rng(3)
    model, _ = random_affine(rng, 2, 2, 1, 1)
    record = white_record(model, rng, 100, 20.0)
    other = VaryingRecord(record.input, record.output, record.scheduling[:, :1], 1.0)
    with pytest.raises(ShapeError, match="the model has"):
        output_error(model, other)
    with pytest.raises(NotIdentifiableError, match="cannot determine"):
        output_error(model, record.part(0, 20))


def test_a_model_that_nothing_determines_is_said_to_be_so():
    rng = np.random.default_rng(4)
    model, _ = random_affine(rng, 2, 1, 1, 1)
    record = white_record(model, rng, 100, 20.0)
    silent = VaryingRecord(0 * record.input, record.output, record.scheduling, 1.0)
    found = output_error(model, silent)
    assert found.outcome.status == "not_identifiable"
    assert found.covariance is None
