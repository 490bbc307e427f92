"""Rational models: responses, gradients, poles; and their parameter-varying form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from identification.errors import RangeError, ShapeError
from identification.models.model import Model
from identification.models.rational import RationalStructure, roots
from tests.support.plants import DEPENDENCE, EXAMPLE, THETA, zeta_of_example

STRUCTURES = [
    RationalStructure(2, 1, 1, 2, 1, sample_time=0.5),
    RationalStructure(0, 0, 0, 0, 2, sample_time=0.5),
    RationalStructure(2, 2, 0, 1, 1, sample_time=0.5, delay=True),
    RationalStructure(3, 1, frequency_scale=2.0),
    RationalStructure(1, 2, frequency_scale=0.5, delay=True),
]
OMEGA = np.linspace(0.1, 5.0, 7)


@pytest.mark.parametrize("structure", STRUCTURES)
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_gradients_are_derivatives(structure, seed):
    zeta = np.random.default_rng(seed).uniform(0.1, 0.9, structure.size)
    step = 1e-6
    for i in range(structure.size):
        shift = step * np.eye(structure.size)[i]
        plant, noise = (
            (f(zeta + shift, OMEGA) - f(zeta - shift, OMEGA)) / (2 * step)
            for f in (structure.plant_response, structure.noise_response)
        )
        if i < structure.n_plant:
            expected = structure.plant_gradient(zeta, OMEGA)[i]
            assert np.allclose(plant, expected, rtol=1e-4, atol=1e-5 * abs(expected).max())
            assert not np.any(noise)
        else:
            expected = structure.noise_gradient(zeta, OMEGA)[i - structure.n_plant]
            assert np.allclose(noise, expected, rtol=1e-4, atol=1e-5 * abs(expected).max())
            assert not np.any(plant)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_many_models_at_once(structure):
    zeta = np.random.default_rng(0).uniform(0.1, 0.9, (3, 2, structure.size))
    assert structure.plant_response(zeta, OMEGA).shape == (3, 2, 7)
    assert structure.plant_gradient(zeta, OMEGA).shape == (3, 2, structure.n_plant, 7)
    assert structure.noise_gradient(zeta, OMEGA).shape == (3, 2, structure.n_noise, 7)
    assert structure.poles(zeta).shape == (3, 2, structure.n_a)
    assert structure.stable(zeta).shape == (3, 2)
    for function in (structure.plant_response, structure.plant_gradient, structure.noise_gradient):
        assert np.allclose(function(zeta, OMEGA)[2, 1], function(zeta[2, 1], OMEGA))


def test_responses_by_hand():
    structure = RationalStructure(1, 1, 2, 1, 1, sample_time=0.5)
    zeta = np.array([-0.5, 2.0, 0.3, 0.4, -0.7])
    q = np.exp(-0.5j * OMEGA)
    assert np.allclose(structure.plant_response(zeta, OMEGA), q**2 * (2 + 0.3 * q) / (1 - 0.5 * q))
    assert np.allclose(structure.noise_response(zeta, OMEGA), (1 + 0.4 * q) / (1 - 0.7 * q))
    continuous = RationalStructure(2, 1, frequency_scale=2.0)
    x = 1j * OMEGA / 2.0
    expected = (3 * x + 4) / (x**2 + 0.5 * x + 2)
    assert np.allclose(continuous.plant_response(np.array([0.5, 2.0, 3.0, 4.0]), OMEGA), expected)


def test_poles_and_stability():
    zeta = np.concatenate([np.poly([0.5, -0.8]).real[1:], [1.0, 1.0], [0.5, 0.0], [-0.9]])
    structure = STRUCTURES[0]
    assert np.allclose(np.sort(structure.poles(zeta).real), [-0.8, 0.5])
    assert structure.stable(zeta)
    for i, value in ((0, 3.0), (4, 2.5), (6, -1.1)):
        unstable = zeta.copy()
        unstable[i] = value
        assert not structure.stable(unstable)
    continuous = RationalStructure(1, 0, frequency_scale=100.0)
    assert np.allclose(continuous.poles(np.array([0.5, 1.0])), [-50.0])
    assert continuous.stable(np.array([0.5, 1.0]))
    assert not continuous.stable(np.array([-0.5, 1.0]))


def test_names_and_sizes():
    structure = RationalStructure(1, 1, 0, 1, 1, sample_time=1.0, delay=True)
    assert structure.coefficient_names == ("a1", "b0", "b1", "tau", "c1", "d1")
    assert (structure.n_plant, structure.n_noise, structure.size) == (4, 2, 6)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000))
def test_roots(seed):
    g = np.random.default_rng(seed)
    zeros = g.uniform(-1, 1, int(g.integers(0, 5)))
    assert np.allclose(
        np.sort(roots(np.poly(zeros)[1:] if len(zeros) else np.zeros(0)).real), np.sort(zeros), atol=1e-3
    )


@pytest.mark.parametrize(
    "options", [{"n_a": -1}, {"n_k": 1}, {"sample_time": 0.0}, {"frequency_scale": -1.0}, {"n_d": 1}]
)
def test_bad_structures(options):
    with pytest.raises(RangeError):
        RationalStructure(**{"n_a": 1, "n_b": 0, **options})
    with pytest.raises(ShapeError):
        RationalStructure(1, 0).split(np.zeros(5))


def test_the_example_at_its_operating_points():
    model = Model(EXAMPLE, DEPENDENCE, THETA, np.eye(6), 0.5)
    points = [[0.0], [1.5], [8.0]]
    assert np.allclose(model.coefficients(points), [zeta_of_example(p[0]) for p in points])
    assert model.parameter_names == ("a1[0]", "a1[1]", "b0[0]", "b0[1]", "d1[0]", "d1[1]")
    assert model.plant_size == 4
    assert np.allclose(model.poles(points)[:, 0], [0.9, 0.75, 0.1])


def test_response_covariance_is_that_of_many_draws():
    g = np.random.default_rng(0)
    root = 1e-3 * g.standard_normal((6, 6))
    model = Model(EXAMPLE, DEPENDENCE, THETA, root @ root.T, 0.5)
    omega = np.array([0.2, 1.0])
    draws = THETA + (root @ g.standard_normal((6, 20000))).T
    zeta = draws @ DEPENDENCE.matrix([[4.0]])[0].T
    responses = EXAMPLE.plant_response(zeta, omega)
    found = model.response_covariance([[4.0]], omega)[0, :, 0, 0]
    for f in range(2):
        sample = np.cov(responses[:, f].real, responses[:, f].imag)
        scale = np.sqrt(np.outer(np.diag(found[f]), np.diag(found[f])))
        assert np.all(abs(found[f] - sample) < 0.05 * scale)


def test_sizes_of_a_parameter_varying_model():
    for theta, covariance in ((np.zeros(5), np.eye(6)), (np.zeros(6), np.eye(5))):
        with pytest.raises(ShapeError):
            Model(EXAMPLE, DEPENDENCE, theta, covariance, 1.0)
    with pytest.raises(ShapeError):
        Model(RationalStructure(2, 0, sample_time=1.0), DEPENDENCE, THETA[:4], np.eye(4), 1.0).coefficients([[0.0]])
