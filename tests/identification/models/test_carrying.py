"""State-space models with effects at operating points held still: along the chart as by their entries."""

import dataclasses

import numpy as np
import pytest

from identification.effects.delay import Delay
from identification.errors import MisuseError
from identification.extension.response import linear_response
from identification.models.model import Model
from identification.models.state_space_model import carrying, charted, joint_of_entries, stacks
from identification.places.placed import placed
from identification.varying.stacks import StackSizes
from tests.identification.varying.models import random_model

OMEGA = np.linspace(0.1, 3.0, 7)


def random_one(seed: int, order: int, n_p: int, known: bool = True) -> Model:
    """A random model with a random covariance of the right rank, in a state basis far from a good one."""
    generator = np.random.default_rng(seed)
    plant = random_model(generator, order, n_p)
    plant = plant.transformed(generator.standard_normal((order, order)) * np.geomspace(0.01, 10, order))
    model = charted(plant.model())
    root = model.chart @ generator.standard_normal((model.plant_size, model.plant_size))
    return plant.model(1e-4 * root @ root.T) if known else plant.model()


@pytest.mark.parametrize(("order", "n_p"), [(1, 1), (2, 1), (3, 2), (4, 1)])
def test_responses_and_their_covariances_are_those_of_the_model(order: int, n_p: int) -> None:
    """By the entries of the matrices, with the covariance of all of them, and along the chart."""
    found = random_one(order + 10 * n_p, order, n_p)
    points = np.random.default_rng(1).uniform(-1, 1, (3, n_p))
    model = carrying(found, (), None)
    gradient = found.structure.gradient(found.coefficients(points), OMEGA)[:, :, 0, 0]
    by_entries = found.dependence.pulled(gradient, points)
    parts = np.stack([by_entries.real, by_entries.imag], axis=-2)
    expected = parts @ found.covariance @ np.swapaxes(parts, -1, -2)
    known = model.response_covariance(points, OMEGA)[:, :, 0, 0]
    assert np.allclose(known, expected, rtol=1e-6, atol=1e-8 * expected.max())
    assert model.plant_size == StackSizes.of(stacks(found)).free
    moved = model.with_parameters(model.parameters * 1.01)
    assert np.allclose((moved.theta - model.theta) @ (np.eye(len(model.theta)) - model.chart @ model.chart.T), 0)


def test_a_model_without_covariance_has_none_and_one_with_several_channels_is_refused() -> None:
    assert carrying(random_one(1, 2, 1, known=False), (), None).known_covariance is None
    wide = random_model(np.random.default_rng(3), 2, 1, 2, 1).model()
    with pytest.raises(MisuseError, match="2 inputs"):
        carrying(wide, (), None)


def test_effects_keep_their_covariance_with_the_parameters_and_their_own() -> None:
    """Kept and read again: θ loses what the state basis takes, the delay nothing."""
    first = carrying(random_one(6, 2, 1), (), None)
    root = np.random.default_rng(2).standard_normal((first.plant_size + 1, first.plant_size + 1))
    model = dataclasses.replace(first.plus(placed(Delay(), 0, 1, 0.3)), joint_covariance=1e-4 * root @ root.T)
    joint = joint_of_entries(model)
    assert joint.shape == (len(model.theta) + 1,) * 2
    bare = dataclasses.replace(model, effects=(), joint_covariance=None)
    again = carrying(bare, model.effects, joint)
    assert again.joint_covariance[-1, -1] == pytest.approx(model.joint_covariance[-1, -1])
    one, other = (linear_response(each, [[0.4]], OMEGA) for each in (model, again))
    assert other.response == pytest.approx(one.response)
    assert other.covariance == pytest.approx(one.covariance, rel=1e-6)
