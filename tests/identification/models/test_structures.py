"""What every structure answers, held against loops over samples, linear solves and differences."""

import numpy as np
import pytest

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, RangeError
from identification.models.chart import gauge_tangent, perpendicular
from identification.models.rational import RationalStructure
from identification.models.state_space import StateSpaceStructure
from identification.models.structure import Structure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

OMEGA = np.array([0.1, 0.7, 2.0])
WIDE = StateSpaceStructure(3, n_u=3, n_y=2, sample_time=0.5)
STRUCTURES = [
    RationalStructure(2, 1, n_k=1, n_c=1, n_d=1, sample_time=0.5),
    RationalStructure(2, 1, frequency_scale=3.0, delay=True),
    StateSpaceStructure(2, sample_time=1.0),
    StateSpaceStructure(3, n_u=2, n_y=2),
    WIDE,
]


def drawn(structure: Structure, seed: int = 1) -> FloatArray:
    return 0.4 * np.random.default_rng(seed).standard_normal((2, structure.size))


def by_differences(f, zeta: FloatArray, count: int) -> np.ndarray:
    step = 1e-6 * np.eye(zeta.shape[-1])[:count]
    return np.stack([(f(zeta + one) - f(zeta - one)) / 2e-6 for one in step], axis=-1)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_gradients_are_derivatives(structure: Structure) -> None:
    zeta = drawn(structure)
    expected = by_differences(lambda z: structure.response(z, OMEGA), zeta, structure.n_plant)
    found = structure.gradient(zeta, OMEGA)
    assert found.shape == (2, 3, structure.outputs, structure.inputs, structure.n_plant)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-6 * abs(expected).max())
    np.testing.assert_allclose(np.swapaxes(structure.plant_gradient(zeta, OMEGA), 1, 2), found[:, :, 0, 0])
    np.testing.assert_allclose(structure.plant_response(zeta, OMEGA), structure.response(zeta, OMEGA)[..., 0, 0])
    assert len(structure.coefficient_names) == structure.size == structure.n_plant + structure.n_noise


@pytest.mark.parametrize("structure", STRUCTURES)
def test_poles_move_as_their_gradient_says(structure: Structure) -> None:
    zeta = drawn(structure)
    poles, gradient = structure.pole_gradient(zeta)
    assert poles.shape == (2, structure.order)
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(structure.poles(zeta)))
    change = 1e-6 * np.random.default_rng(2).standard_normal(structure.n_plant)
    moved = zeta.copy()
    moved[:, : structure.n_plant] += change
    expected = np.sort_complex(structure.poles(moved)) - np.sort_complex(poles)
    order = np.argsort(poles, axis=-1)
    found = np.take_along_axis(gradient @ change, order, axis=-1)
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-9)


def test_a_state_space_answers_what_its_equations_say() -> None:
    zeta = drawn(WIDE)[0]
    a, b, c, d = WIDE.matrices(zeta)
    for omega, found in zip(OMEGA, WIDE.response(zeta, OMEGA), strict=True):
        states = np.linalg.solve(np.exp(1j * omega * 0.5) * np.eye(3) - a, b)
        np.testing.assert_allclose(found, c @ states + d)
    assert WIDE.coefficient_names[9] == "B(1,1)"
    assert WIDE.coefficient_names[-1] == "D(2,3)"


@pytest.mark.parametrize("structure", [STRUCTURES[0], STRUCTURES[2], WIDE])
def test_along_follows_the_difference_equation_sample_by_sample(structure: Structure) -> None:
    g = np.random.default_rng(3)
    zeta = 0.3 * g.standard_normal((25, structure.size))
    u = g.standard_normal((25, structure.inputs))
    found = structure.along(zeta, u)
    np.testing.assert_allclose(found.output, stepped(structure, zeta, u), atol=1e-12)
    change = g.standard_normal((25, structure.n_plant))
    step = np.pad(1e-6 * change, ((0, 0), (0, structure.n_noise)))
    expected = (structure.along(zeta + step, u).output - structure.along(zeta - step, u).output) / 2e-6
    np.testing.assert_allclose(found.change(change), expected, atol=1e-6 * abs(expected).max())


def stepped(structure: Structure, zeta: FloatArray, u: FloatArray) -> FloatArray:
    y = np.zeros((len(u), structure.outputs))
    if isinstance(structure, StateSpaceStructure):
        x = np.zeros(structure.order)
        for t in range(len(u)):
            a, b, c, d = structure.matrices(zeta[t])
            y[t], x = c @ x + d @ u[t], a @ x + b @ u[t]
        return y
    before = np.concatenate([np.zeros((2, 1)), u])
    out = np.concatenate([np.zeros((2, 1)), y])
    for t in range(len(u)):
        a1, a2, b0, b1 = zeta[t, :4]
        out[t + 2] = b0 * before[t + 1] + b1 * before[t] - a1 * out[t + 1] - a2 * out[t]
    return out[2:]


def test_no_response_shows_the_directions_of_the_gauge() -> None:
    variables = (SchedulingVariable("p", "", -1.0, 1.0),)
    bases = tuple(ProductBasis((Polynomial(n),)) for n in (1, 2, 0, 1))
    dependence = ParameterDependence(variables, bases, tuple(len(group.entries) for group in WIDE.groups))
    theta = 0.3 * np.random.default_rng(4).standard_normal(dependence.size)
    tangent = gauge_tangent(WIDE, dependence, theta)
    assert tangent.shape == (dependence.size, 9)
    points = np.array([[-0.6], [0.9]])
    gradient = dependence.pulled(WIDE.gradient(dependence.coefficients(theta, points), OMEGA), points)
    scale = abs(gradient).max()
    assert np.linalg.matrix_rank(tangent) == 9
    np.testing.assert_allclose(gradient @ tangent, 0, atol=1e-10 * scale)
    chart = perpendicular(tangent)
    assert chart.shape == (dependence.size, dependence.size - 9)
    np.testing.assert_allclose(chart.T @ tangent, 0, atol=1e-12)


def test_misuse_is_refused() -> None:
    for bad in ({"n_x": -1}, {"n_x": 1, "n_u": 0}, {"n_x": 1, "sample_time": 0.0}):
        with pytest.raises(RangeError):
            StateSpaceStructure(**bad)
    for structure in STRUCTURES[1::2]:
        with pytest.raises(MisuseError, match="discrete time"):
            structure.along(drawn(structure), np.ones((2, structure.inputs)))
