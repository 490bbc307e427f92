"""The time-domain likelihood: its gradient, its minimum, and the covariance that it states."""

import numpy as np
import pytest

from benchmarks.affine_plant import AffinePlant, with_constant
from identification.along import simulate_along
from identification.errors import NotIdentifiableError, ShapeError
from identification.varying.output_error import OutputError, _Problem, output_error
from identification.varying.records import VaryingRecord
from identification.varying.scheduled import Signals
from identification.varying.stacks import StackSizes
from tests.support.random_state_space import random_affine, white_record


def signals(record):
    return Signals(record.input, record.output, with_constant(record.scheduling))


def perturbed(model, rng, size):
    sizes = StackSizes.of(model.matrices)
    theta = sizes.join(model.matrices)
    return sizes.split(theta + size * rng.standard_normal(sizes.size))


def test_the_gradient_is_that_of_the_cost():
    rng = np.random.default_rng(0)
    model, _ = random_affine(rng, 3, 2, 2, 2)
    record = white_record(model, rng, 80, 10.0)
    noise = np.array([[1.0, 0.3], [0.3, 2.0]])
    initial = rng.standard_normal(3)
    problem = _Problem(model.matrices, initial, signals(record), noise, np.full(2, 1e-20))

    def cost(beta):
        errors = record.output - AffinePlant(*problem.matrices(beta)).simulate(
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
    found = output_error(perturbed(model, rng, 0.03), signals(record))
    assert found.outcome.ok
    assert np.linalg.norm(found.errors) < 1e-9 * np.linalg.norm(record.output)


def test_a_record_may_begin_in_any_state():
    rng = np.random.default_rng(5)
    model, _ = random_affine(rng, 2, 2, 2, 2)
    whole = white_record(model, rng, 700, 30.0)
    record = whole.part(200, 600)
    found = output_error(perturbed(model, rng, 0.03), signals(record))
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
        start = AffinePlant(*perturbed(model, rng, 0.02)).model()
        found = OutputError().estimate(record, None, start)
        seen = simulate_along(found.model, u, p)
        distances.append((seen.output - truth)[:, 0] ** 2 / seen.deviation[:, 0] ** 2)
        noise.append(np.trace(found.found.noise_covariance) / np.trace(np.diag(np.mean(record.output**2, axis=0))))
        assert found.outcome.ok
    ratio = np.mean(distances)
    assert 0.75 < ratio < 1.3, ratio
    assert np.mean(noise) == pytest.approx(0.1 / 1.1 * (1 - 7 / 600), rel=0.03)


def test_sizes_that_do_not_fit():
    rng = np.random.default_rng(3)
    model, _ = random_affine(rng, 2, 2, 1, 1)
    record = white_record(model, rng, 100, 20.0)
    other = VaryingRecord(record.input, record.output, record.scheduling[:, :1], 1.0)
    with pytest.raises(ShapeError, match="the record 1 scheduling"):
        OutputError().estimate(other, None, model.model())
    with pytest.raises(NotIdentifiableError, match="cannot determine"):
        OutputError().estimate(record.part(0, 20), None, model.model())


def test_a_model_that_nothing_determines_is_said_to_be_so():
    rng = np.random.default_rng(4)
    model, _ = random_affine(rng, 2, 1, 1, 1)
    record = white_record(model, rng, 100, 20.0)
    silent = VaryingRecord(0 * record.input, record.output, record.scheduling, 1.0)
    found = OutputError().estimate(silent, None, model.model())
    assert found.outcome.status == "not_identifiable"
    assert found.model.covariance is None
