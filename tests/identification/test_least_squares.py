"""Levenberg–Marquardt: minima, edges, and what it says when there is none."""

import numpy as np
import pytest

from identification.least_squares import is_singular, levenberg_marquardt


def rosenbrock(x):
    residual = np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]])
    return residual, np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


def test_a_curved_valley():
    solution = levenberg_marquardt(rosenbrock, np.array([-1.2, 1.0]))
    assert solution.outcome.ok
    assert np.allclose(solution.x, 1, atol=1e-8)
    assert solution.cost < 1e-15


@pytest.mark.parametrize("units", [np.ones(3), np.array([1e-12, 1.0, 1e12])])
def test_linear_problems_in_any_units(units):
    g = np.random.default_rng(0)
    A, b = g.standard_normal((20, 3)) / units, g.standard_normal(20)
    solution = levenberg_marquardt(lambda x: (A @ x - b, A), np.zeros(3))
    assert solution.outcome.ok
    assert np.allclose(solution.x / units, np.linalg.lstsq(A * units, b)[0])
    expected = np.linalg.inv((A * units).T @ (A * units))
    assert np.allclose(solution.covariance / np.outer(units, units), expected)


def test_no_more_than_rounding_is_asked_for():
    A = np.vander(np.linspace(0, 1, 30), 4)
    x = np.array([1e8, -2.0, 3.0, 1.0])
    solution = levenberg_marquardt(lambda z: (A @ z - A @ x, A), np.zeros(4))
    assert solution.outcome.ok
    assert solution.outcome.iterations < 20


def test_parameters_without_influence_are_not_identifiable():
    def evaluate(x):
        return np.array([x[0] + x[1] - 1, 2 * (x[0] + x[1]), 0.5]), np.array([[1.0, 1.0], [2.0, 2.0], [0.0, 0.0]])

    solution = levenberg_marquardt(evaluate, np.zeros(2))
    assert solution.outcome.status == "not_identifiable"
    assert np.all(np.isinf(solution.covariance))
    assert solution.outcome.advice


def test_the_region_is_never_left():
    visited = []

    def evaluate(x):
        visited.append(x[0])
        return np.array([x[0] - 3.0, 0.1]), np.array([[1.0], [0.0]])

    solution = levenberg_marquardt(evaluate, np.zeros(1), lambda x: bool(x[0] < 1))
    assert max(visited) < 1
    assert solution.x[0] > 0.9
    assert solution.outcome.status == "not_converged"


def test_infinite_residuals_are_not_accepted():
    def evaluate(x):
        value = np.inf if x[0] > 1 else x[0] - 1.0
        return np.array([value, 1.0]), np.array([[1.0], [0.0]])

    assert np.isfinite(levenberg_marquardt(evaluate, np.array([-5.0])).cost)


def test_stops_after_so_many_iterations():
    solution = levenberg_marquardt(rosenbrock, np.array([-1.2, 1.0]), max_iterations=2)
    assert solution.outcome.status == "not_converged"
    assert solution.outcome.iterations == 2


def test_is_singular():
    assert not is_singular(np.diag([1.0, 1e-30]))
    assert is_singular(np.ones((3, 2)))
    assert is_singular(np.zeros((3, 1)))
