"""Affine models at frozen operating points: the same responses and covariances as the model itself."""

import dataclasses

import numpy as np
import pytest

from identification.effects.delay import Delay
from identification.errors import MisuseError
from identification.extension.response import linear_response
from identification.outcome import Outcome
from identification.places.placed import placed
from identification.scheduling import SchedulingVariable
from identification.varying.affine_estimate import AffineEstimate
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace
from identification.varying.frozen import affine_estimate, affine_model, frozen, smallest_basis
from tests.identification.varying.models import random_model

OMEGA = np.linspace(0.1, 3.0, 7)


def estimate(seed: int, order: int, n_p: int, known: bool = True) -> AffineEstimate:
    """A random model with a random covariance of the right rank, in a state basis far from a good one."""
    generator = np.random.default_rng(seed)
    variables = tuple(SchedulingVariable(f"p{i}", "", -1.0, 1.0) for i in range(n_p))
    model = dataclasses.replace(random_model(generator, order, n_p), variables=variables)
    model = model.transformed(generator.standard_normal((order, order)) * np.geomspace(0.01, 10, order))
    sizes = AffineSizes.of(model)
    chart = sizes.chart(sizes.join((model.a, model.b, model.c, model.d)))
    root = chart @ generator.standard_normal((sizes.free, sizes.free))
    return AffineEstimate(model, Outcome("converged"), (), 1e-4 * root @ root.T if known else None)


def theta(model: AffineStateSpace) -> np.ndarray:
    return AffineSizes.of(model).join((model.a, model.b, model.c, model.d))


@pytest.mark.parametrize(("order", "n_p"), [(1, 1), (2, 1), (3, 2), (4, 1)])
def test_responses_and_their_covariances_are_those_of_the_model(order: int, n_p: int) -> None:
    found = estimate(order + 10 * n_p, order, n_p)
    model = frozen(found)
    again, _ = affine_estimate(model)
    assert np.allclose(
        affine_model(again).response_covariance(np.zeros((1, n_p)), OMEGA),
        affine_model(found).response_covariance(np.zeros((1, n_p)), OMEGA),
        rtol=1e-6,
    )
    points = np.random.default_rng(1).uniform(-1, 1, (3, n_p))
    assert np.allclose(
        model.frequency_response(points, OMEGA),
        found.model.frequency_response(points, OMEGA),
        rtol=1e-8,
    )
    expected = affine_model(found).response_covariance(points, OMEGA)
    assert np.allclose(model.response_covariance(points, OMEGA), expected, rtol=1e-6, atol=1e-8 * expected.max())
    assert model.plant_size == AffineSizes.of(found.model).free
    poles = np.sort_complex(model.poles(points))
    assert np.allclose(poles, np.sort_complex(np.linalg.eigvals(found.model.frozen(points)[0])), atol=1e-8)


def test_the_gradient_is_the_derivative() -> None:
    base = frozen(estimate(5, 3, 1))
    zeta = base.coefficients([[0.3], [-0.7]])
    direction = np.random.default_rng(2).standard_normal(zeta.shape[1])
    step = 1e-6 * direction
    difference = base.structure.plant_response(zeta + step, OMEGA) - base.structure.plant_response(zeta - step, OMEGA)
    tangent = np.einsum("mkf,k->mf", base.structure.plant_gradient(zeta, OMEGA), direction)
    assert np.allclose(difference / 2e-6, tangent, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_in_the_smallest_basis_the_parameters_lie_in_their_own_chart(seed: int) -> None:
    model = estimate(seed, 2 + seed % 3, 1 + seed % 2).model
    small = model.transformed(smallest_basis(model))
    assert np.allclose(AffineSizes.of(small).similarity_tangent(theta(small)).T @ theta(small), 0, atol=1e-10)
    generator = np.random.default_rng(seed)
    for _ in range(20):
        nearby = small.transformed(np.eye(model.order) + 0.1 * generator.standard_normal((model.order, model.order)))
        assert np.linalg.norm(theta(nearby)) >= np.linalg.norm(theta(small)) * (1 - 1e-12)


def test_a_model_without_covariance_has_none_and_one_with_several_channels_is_refused() -> None:
    assert frozen(estimate(1, 2, 1, known=False)).joint_covariance is None
    wide = random_model(np.random.default_rng(3), 2, 1, 2, 1)
    with pytest.raises(MisuseError, match="2 inputs"):
        frozen(AffineEstimate(wide, Outcome("converged"), ()))


def test_effects_keep_their_covariance_with_the_parameters_and_their_own() -> None:
    """Kept and read again: θ loses what the state basis takes, the delay nothing."""
    found = estimate(6, 2, 1)
    free = AffineSizes.of(found.model).free
    root = np.random.default_rng(2).standard_normal((free + 1, free + 1))
    model = frozen(found).plus(placed(Delay(), 0, 1, 0.3))
    model = dataclasses.replace(model, joint_covariance=1e-4 * root @ root.T)
    kept, joint = affine_estimate(model)
    again = frozen(kept, model.effects, joint)
    assert again.joint_covariance[-1, -1] == pytest.approx(model.joint_covariance[-1, -1])
    one, other = (linear_response(each, [[0.4]], OMEGA) for each in (model, again))
    assert other.response == pytest.approx(one.response)
    assert other.covariance == pytest.approx(one.covariance, rel=1e-6)
