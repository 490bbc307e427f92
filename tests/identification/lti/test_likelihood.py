"""Residuals and their derivatives: right in value and in sign."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.errors import MisuseError
from identification.lti.initial_conditions import errors_from, errors_only, simulated_output
from identification.lti.likelihood import delayed, prediction_errors, residual_and_jacobian, response_errors
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate
from tests.support.plants import random_polynomial


def model_and_record(seed, samples=60):
    g = np.random.default_rng(seed)
    orders = [int(g.integers(0, 4)) for _ in range(5)]
    structure = RationalStructure(*orders, sample_time=1.0)
    a, c, d = (random_polynomial(g, order, 0.9)[1:] for order in (orders[0], orders[3], orders[4]))
    zeta = np.concatenate([a, g.standard_normal(orders[1] + 1), c, d])
    u, y = g.standard_normal((2, samples))
    return structure, zeta, TimeRecord(u, y, 1.0, (0.0,))


def differences(function, x, step=1e-6):
    columns = []
    for i in range(len(x)):
        shift = np.zeros(len(x))
        shift[i] = step
        columns.append((function(x + shift) - function(x - shift)) / (2 * step))
    return np.stack(columns, axis=1)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_gradient_of_prediction_errors(seed):
    structure, zeta, record = model_and_record(seed)
    errors, jacobian = prediction_errors(structure, zeta, record)
    numeric = differences(lambda z: prediction_errors(structure, z, record)[0], zeta)
    assert np.allclose(jacobian, numeric, rtol=1e-4, atol=1e-5 * (1 + abs(numeric).max()))
    assert np.allclose(errors, residual_and_jacobian(structure, zeta, record)[0])


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10_000))
def test_gradient_with_a_transient(seed):
    structure, zeta, record = model_and_record(seed)
    state = np.random.default_rng(seed).standard_normal(structure.n_a)
    both = np.concatenate([zeta, state])

    def errors(x):
        return prediction_errors(structure, x[: structure.size], record, x[structure.size :])[0]

    jacobian = prediction_errors(structure, zeta, record, state)[1]
    numeric = differences(errors, both)
    assert np.allclose(jacobian, numeric, rtol=1e-4, atol=1e-5 * (1 + abs(numeric).max()))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_prediction_errors_of_the_truth_are_the_noise(seed):
    structure, zeta, record = model_and_record(seed)
    noise = np.random.default_rng(seed).standard_normal(len(record))
    true = TimeRecord(record.input, simulate(structure, zeta, record.input, noise), 1.0, (0.0,))
    assert np.allclose(prediction_errors(structure, zeta, true)[0], noise, atol=1e-8)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_the_fitted_initial_state_is_optimal_and_marginalised(seed):
    structure, zeta, record = model_and_record(seed)
    errors, jacobian = errors_from(structure, zeta, record, "estimate")
    assert np.allclose(errors, errors_only(structure, zeta, record, "estimate"), atol=1e-9)
    states = np.zeros(structure.n_a)
    full = prediction_errors(structure, zeta, record, states)[1][:, structure.size :]
    assert np.allclose(full.T @ errors, 0, atol=1e-7 * (1 + np.abs(full).sum()))
    assert np.allclose(full.T @ jacobian, 0, atol=1e-7 * (1 + np.abs(full).sum() * np.abs(jacobian).max(initial=0)))

    def cost(z):
        e = errors_only(structure, z, record, "estimate")
        return np.array([e @ e])

    numeric = differences(cost, zeta)[0]
    assert np.allclose(2 * jacobian.T @ errors, numeric, rtol=1e-3, atol=1e-4 * (1 + abs(numeric).max()))


def test_without_an_initial_state_records_start_from_rest():
    structure, zeta, record = model_and_record(3)
    for one, other in zip(
        errors_from(structure, zeta, record, "zero"), prediction_errors(structure, zeta, record), strict=True
    ):
        assert np.array_equal(one, other)
    assert np.allclose(errors_only(structure, zeta, record, "zero"), prediction_errors(structure, zeta, record)[0])


def test_simulated_output_starts_where_the_record_does():
    structure = RationalStructure(2, 1, 1, sample_time=1.0)
    zeta = np.array([-1.8, 0.9, 1.0, 0.5])
    u = np.random.default_rng(0).standard_normal(300)
    y = simulate(structure, zeta, u)
    record = TimeRecord(u[100:], y[100:], 1.0, (0.0,))
    assert np.allclose(simulated_output(structure, zeta, record, "estimate"), y[100:], atol=1e-9)
    assert not np.allclose(simulated_output(structure, zeta, record, "zero"), y[100:], atol=1e-2)


@pytest.mark.parametrize(
    "structure", [RationalStructure(2, 1, delay=True), RationalStructure(2, 2, 1, sample_time=0.5)]
)
@pytest.mark.parametrize("known", [True, False])
def test_response_errors_and_their_gradient(structure, known):
    g = np.random.default_rng(0)
    omega = np.linspace(0.2, 6.0, 15)
    zeta = np.array([0.6, 0.2, 1.0, -0.5, 0.3])
    variance = g.uniform(0.5, 2.0, 15) if known else None
    response = structure.plant_response(zeta, omega) + 0.1
    data = FrequencyResponse(omega, response, (0.0,), structure.sample_time, variance)
    errors, jacobian = residual_and_jacobian(structure, zeta, data)
    weights = 1.0 if variance is None else 1 / np.sqrt(variance)
    assert np.allclose(errors, np.concatenate([np.sqrt(2) * weights * 0.1 * np.ones(15), np.zeros(15)]))
    numeric = differences(lambda z: residual_and_jacobian(structure, z, data)[0], zeta)
    assert np.allclose(jacobian, numeric, rtol=1e-5, atol=1e-6)
    halved = response_errors(structure, zeta, data, np.full(15, 0.5))[0]
    assert np.allclose(halved[:15], np.sqrt(2) * 0.5 * 0.1)


def test_responses_say_nothing_of_the_noise_model():
    structure = RationalStructure(1, 0, 1, 1, 1, sample_time=1.0)
    zeta = np.array([-0.5, 1.0, 0.2, -0.3])
    data = FrequencyResponse([0.1, 1.0], structure.plant_response(zeta, np.array([0.1, 1.0])), (0.0,), 1.0)
    errors, jacobian = residual_and_jacobian(structure, zeta, data)
    assert np.allclose(errors, 0)
    assert not np.any(jacobian[:, 2:])
    assert np.any(jacobian[:, :2])


def test_delayed():
    assert np.array_equal(delayed(np.array([1.0, 2, 3]), 1, 2), [[0, 0], [1, 0], [2, 1]])
    assert delayed(np.ones(2), 5, 1).sum() == 0
    assert delayed(np.ones(2), 0, 0).shape == (2, 0)


def test_other_sampling_is_refused():
    record = TimeRecord([1.0, 2.0], [1.0, 2.0], 0.1, (0.0,))
    for structure in (RationalStructure(1, 0), RationalStructure(1, 0, sample_time=0.1, delay=True)):
        with pytest.raises(MisuseError, match="frequency response"):
            residual_and_jacobian(structure, np.zeros(structure.size), record)
    with pytest.raises(MisuseError, match="sample time"):
        residual_and_jacobian(RationalStructure(1, 0, sample_time=0.2), np.zeros(2), record)
    response = FrequencyResponse([1.0], [1.0], (0.0,), 0.1)
    with pytest.raises(MisuseError, match="sample time"):
        residual_and_jacobian(RationalStructure(1, 0), np.zeros(2), response)
