"""Simulation along p(t), frozen responses, and how a fit is rated."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.affine_plant import AffinePlant
from identification.errors import RangeError
from identification.varying.eigenvalues import eigenvalues
from identification.varying.rates import best_fit_rate, variance_accounted_for
from identification.varying.stacks import simulated, transformed
from tests.identification.varying.models import random_model, step_by_step


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 40), st.integers(1, 3), st.integers(1, 3))
def test_simulation_is_what_the_equations_say(seed: int, samples: int, order: int, n_p: int) -> None:
    generator = np.random.default_rng(seed)
    model = random_model(generator, order, n_p, 2, 2)
    u, p = generator.standard_normal((samples, 2)), generator.uniform(-1, 1, (samples, n_p))
    x = generator.standard_normal(order)
    psi = np.column_stack([np.ones(samples), p])
    assert np.allclose(simulated(model.matrices, u, psi, x)[1], step_by_step(model, u, p, x), atol=1e-12)


def test_runs_are_simulated_side_by_side() -> None:
    generator = np.random.default_rng(1)
    model = random_model(generator, 3, 2)
    u, p = generator.standard_normal((4, 50, 1)), generator.uniform(-1, 1, (4, 50, 2))
    psi = np.concatenate([np.ones((4, 50, 1)), p], axis=-1)
    together = simulated(model.matrices, u, psi)[1]
    assert np.allclose(together, [model.simulate(u[i], p[i]) for i in range(4)])
    shared = simulated(model.matrices, u, psi[0])[1]
    assert np.allclose(shared[2], model.simulate(u[2], p[0]))


def test_another_state_basis_changes_no_response() -> None:
    generator = np.random.default_rng(3)
    model = random_model(generator, 3, 2, 2, 2)
    other = AffinePlant(*transformed(model.matrices, generator.standard_normal((3, 3))))
    points, omega = generator.uniform(-1, 1, (5, 2)), np.linspace(0, np.pi, 7)
    expected = model.frequency_response(points, omega)
    assert np.allclose(other.frequency_response(points, omega), expected)
    assert np.allclose(other.model().frequency_response(points, omega), expected)
    found, back = eigenvalues(other.model()), [0, 2, 1]
    assert np.allclose(np.sort_complex(found[back]), np.sort_complex(model.eigenvalues()))


def test_the_frozen_response_is_that_of_a_sine_at_constant_scheduling() -> None:
    plant, omega = random_model(np.random.default_rng(4)), 0.7
    t = np.arange(400)
    y = plant.simulate(np.cos(omega * t)[:, None], np.full((400, 1), 0.4))[:, 0]
    g = plant.model().frequency_response(np.array([[0.4]]), np.array([omega]))[0, 0, 0, 0]
    assert np.allclose(y[200:], (g * np.exp(1j * omega * t)).real[200:], atol=1e-9)


def test_fits_of_known_errors() -> None:
    generator = np.random.default_rng(6)
    y = generator.standard_normal((1000, 2))
    assert best_fit_rate(y, y) == variance_accounted_for(y, y) == 100
    assert variance_accounted_for(y, y + 3.0) == pytest.approx(100)
    assert best_fit_rate(y - y.mean(axis=0), 0.9 * (y - y.mean(axis=0))) == pytest.approx(90)
    assert variance_accounted_for(y, 0.9 * y) == pytest.approx(99)
    assert variance_accounted_for(y, -y) == 0
    with pytest.raises(RangeError, match="constant"):
        variance_accounted_for(np.ones((5, 1)), np.ones((5, 1)))
