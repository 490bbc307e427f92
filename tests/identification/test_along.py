"""Simulations along p(t): the equations sample by sample, and deviations that are those of the parameters."""

from dataclasses import replace

import numpy as np
import pytest

from identification.along import simulate_along
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, RangeError
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.models.state_space_model import state_space_model
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.simulation import simulate
from tests.identification.varying.models import random_model

VARIABLE = SchedulingVariable("p", "V", -1.0, 1.0)
AFFINE = ProductBasis((Polynomial(1),))
SAMPLES = 200


def model(n_k: int = 1, **changes: object) -> Model:
    structure = RationalStructure(**{"n_a": 2, "n_b": 1, "n_k": n_k, "n_d": 1, "sample_time": 0.5, **changes})
    dependence = ParameterDependence((VARIABLE,), (AFFINE,) * structure.size)
    theta = np.array([-0.9, 0.2, 0.3, -0.1, 1.0, 0.4, 0.5, -0.2, -0.5, 0.1])[: dependence.size]
    root = 0.01 * np.random.default_rng(1).standard_normal((dependence.size,) * 2)
    return Model(structure, dependence, theta, root @ root.T, 1.0)


def signals(seed: int = 2) -> tuple[np.ndarray, np.ndarray]:
    g = np.random.default_rng(seed)
    return g.standard_normal(SAMPLES), g.uniform(-1, 1, (SAMPLES, 1))


@pytest.mark.parametrize("n_k", [0, 1, 3])
def test_coefficients_follow_p_at_once(n_k: int) -> None:
    one, (u, p) = model(n_k), signals()
    found = simulate_along(one, u[:, None], p).output[:, 0]
    zeta = one.coefficients(p)
    y = np.zeros(SAMPLES)
    for t in range(SAMPLES):
        a1, a2, b0, b1 = zeta[t, :4]
        past = [y[t - i] if t >= i else 0.0 for i in (1, 2)]
        driven = [u[t - n_k - i] if t >= n_k + i else 0.0 for i in (0, 1)]
        y[t] = -a1 * past[0] - a2 * past[1] + b0 * driven[0] + b1 * driven[1]
    assert np.allclose(found, y, atol=1e-12)


def test_held_still_it_is_the_simulation_at_that_point() -> None:
    one, (u, _) = model(), signals()
    found = simulate_along(one, u[:, None], np.full((SAMPLES, 1), 0.3)).output[:, 0]
    assert np.allclose(found, simulate(one.structure, one.coefficients([[0.3]])[0], u), atol=1e-12)


def test_the_deviation_is_that_of_the_parameters_to_first_order() -> None:
    one, (u, p) = model(), signals()
    found = simulate_along(one, u[:, None], p)
    gradient = np.zeros((SAMPLES, one.plant_size))
    for k in range(one.plant_size):
        step = np.zeros(len(one.theta))
        step[k] = 1e-6
        up, down = (simulate_along(replace(one, theta=one.theta + sign * step), u[:, None], p) for sign in (1, -1))
        gradient[:, k] = (up.output - down.output)[:, 0] / 2e-6
    covariance = one.covariance[: one.plant_size, : one.plant_size]
    expected = np.sqrt(np.einsum("tk,kl,tl->t", gradient, covariance, gradient))
    assert found.deviation is not None
    assert np.allclose(found.deviation[:, 0], expected, rtol=1e-5, atol=1e-9)
    assert simulate_along(one, u[:, None], p, covariance_known=False).deviation is None


def test_state_space_models_of_frozen_points_follow_p_too() -> None:
    affine = random_model(np.random.default_rng(3), 2, 1, 2, 2)
    u, p = np.random.default_rng(4).standard_normal((SAMPLES, 2)), signals()[1]
    matrices = (affine.a, affine.b, affine.c, affine.d)
    frozen = state_space_model((VARIABLE,), (AFFINE,) * 4, matrices, 1.0)
    assert np.allclose(simulate_along(frozen, u, p, covariance_known=False).output, affine.simulate(u, p))
    with pytest.raises(MisuseError, match="discrete"):
        simulate_along(state_space_model((VARIABLE,), (AFFINE,) * 4, matrices, None), u, p)


def test_misuse_is_refused() -> None:
    one, (u, p) = model(), signals()
    with pytest.raises(RangeError, match="outside its range"):
        simulate_along(one, u[:, None], 2 * p)
    long, unstable = np.ones(5000), Model(one.structure, one.dependence, 3 * one.theta, one.covariance, 1.0)
    with pytest.raises(RangeError, match="unstable along"):
        simulate_along(unstable, long[:, None], 0 * long[:, None])
    with pytest.raises(MisuseError, match="delay"):
        simulate_along(model(n_d=0, delay=True), u[:, None], p)
