"""State-space models against their definition, and parameter-varying ones at frozen operating points."""

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.state_space_model import stacks, state_space_model
from identification.models.system import StateSpace
from identification.scheduling import ProductBasis, SchedulingVariable
from tests.support.state_space import random_system

OMEGA = np.linspace(0.05, 6.0, 25)


def direct(system, omega):
    z = 1j * omega if system.sample_time is None else np.exp(1j * omega * system.sample_time)
    one = np.eye(system.order)
    return np.stack([system.d + system.c @ np.linalg.solve(x * one - system.a, system.b) for x in z])


@pytest.mark.parametrize("sample_time", [None, 0.5])
@pytest.mark.parametrize("order", [0, 1, 2, 7])
def test_the_response_is_that_of_the_definition(order, sample_time):
    system = random_system(np.random.default_rng(order), order, 2, 3, sample_time)
    response = system.frequency_response(OMEGA)
    assert response.shape == (25, 3, 2)
    assert np.allclose(response, direct(system, OMEGA), rtol=1e-10)
    assert np.allclose(system.c @ system.states(OMEGA) + system.d, response, rtol=1e-10)
    assert np.allclose(system.adjoint_states(OMEGA) @ system.b + system.d, response, rtol=1e-10)


def test_a_jordan_block_needs_no_eigenvectors():
    a = 0.7 * np.eye(5) + np.diag(np.ones(4), 1)
    system = StateSpace(a, np.eye(5)[:, -1:], np.eye(5)[:1], [[0.0]], 1.0)
    z = np.exp(1j * OMEGA[:10] / 2)
    assert np.allclose(system.frequency_response(OMEGA[:10] / 2)[:, 0, 0], (z - 0.7) ** -5.0, rtol=1e-9)


def test_arrays_of_systems():
    systems = [random_system(np.random.default_rng(i), 4, 2, 2, 0.5) for i in range(3)]
    stacked = StateSpace(*(np.stack([getattr(s, m) for s in systems]) for m in "abcd"), 0.5)
    assert np.allclose(stacked.frequency_response(OMEGA), [direct(s, OMEGA) for s in systems])
    assert stacked.poles.shape == (3, 4)
    assert np.array_equal(stacked.stable, [True] * 3)


def test_stability():
    assert not StateSpace([[1.0]], [[1.0]], [[1.0]], [[0.0]], 1.0).stable
    assert not StateSpace([[0.5]], [[1.0]], [[1.0]], [[0.0]]).stable
    assert StateSpace([[-0.5]], [[1.0]], [[1.0]], [[0.0]]).stable


def test_a_change_of_state_changes_no_response():
    g = np.random.default_rng(1)
    system = random_system(g, 4, 2, 3, 0.5)
    other = system.transformed(g.standard_normal((4, 4)))
    assert not np.allclose(other.a, system.a)
    assert np.allclose(other.frequency_response(OMEGA), system.frequency_response(OMEGA))


def test_simulation_is_the_recursion():
    g = np.random.default_rng(4)
    system = random_system(g, 5, 2, 3, 0.5)
    u, x = g.standard_normal((60, 2)), g.standard_normal(5)
    simulated = system.simulate(u, x)
    for t in range(60):
        assert np.allclose(simulated[t], system.c @ x + system.d @ u[t])
        x = system.a @ x + system.b @ u[t]


def test_misuse():
    system = random_system(np.random.default_rng(0), 2, 1, 1, None)
    with pytest.raises(MisuseError, match="discrete"):
        system.simulate(np.zeros((5, 1)))
    with pytest.raises(ShapeError, match="shapes"):
        StateSpace(np.eye(2), np.ones((3, 1)), np.ones((1, 2)), [[0.0]])
    with pytest.raises(RangeError, match="sample time"):
        StateSpace([[0.0]], [[0.0]], [[0.0]], [[0.0]], -1.0)
    with pytest.raises(RangeError, match="pole"):
        StateSpace([[0.0]], [[1.0]], [[1.0]], [[0.0]]).frequency_response([0.0])


def varying():
    g = np.random.default_rng(3)
    variables = (SchedulingVariable("p", "", 0.0, 1.0), SchedulingVariable("r", "", -1.0, 1.0))
    affine, constant = ProductBasis((Polynomial(1), Polynomial(1)), 1), ProductBasis((Polynomial(0), Polynomial(0)))
    shapes = (3, 3, 3), (1, 3, 2), (3, 2, 3), (1, 2, 2)
    matrices = tuple(0.2 * g.standard_normal(s) for s in shapes)
    return state_space_model(variables, (affine, constant, affine, constant), matrices, 0.5)


def test_affine_matrices_at_frozen_points():
    model, points = varying(), np.array([[0.3, -0.5], [1.0, 1.0]])
    (a, b, _, _), frozen = stacks(model), model.structure.matrices(model.coefficients(points))
    # The functions in order: 1, r, p.
    assert np.allclose(frozen[0][0], a[0] - 0.5 * a[1] + 0.3 * a[2])
    assert np.allclose(frozen[1], b[0])
    one = StateSpace(*(part[1] for part in frozen), 0.5)
    assert np.allclose(model.frequency_response(points, OMEGA)[1], direct(one, OMEGA))
    assert np.allclose(np.sort_complex(model.poles(points)[1]), np.sort_complex(one.poles))
    assert np.array_equal(model.stable(points), abs(model.poles(points)).max(axis=1) < 1)


def test_misuse_of_bases():
    model = varying()
    with pytest.raises(ShapeError, match="one per function"):
        state_space_model(model.variables, model.dependence.bases[:1] * 4, stacks(model), 0.5)
    with pytest.raises(ShapeError, match="bases"):
        state_space_model(model.variables, model.dependence.bases[:2], stacks(model), 0.5)
    with pytest.raises(RangeError, match="range"):
        model.poles([[2.0, 0.0]])
