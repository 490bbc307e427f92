"""The frequency response of models with effects against formulas and differences."""

from dataclasses import replace

import numpy as np
import pytest

from identification.arrays import ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.drift_of_gain import DriftOfGain
from identification.effects.quadratic_dependence import QuadraticDependence
from identification.effects.resonance import Resonance
from identification.extension.response import coefficients, linear_response
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.places.place import Effect
from identification.places.placed import placed
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

DEPENDENCE = ParameterDependence(
    (SchedulingVariable("p", "1", -1.0, 3.0),), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0))
)
BASE = Model(RationalStructure(2, 0), DEPENDENCE, np.array([1.8, 64.0, 5.0, 2.0]), np.zeros((4, 4)), 1.0)
POINTS, OMEGA = [(-1.0,), (2.0,)], np.geomspace(1.0, 30.0, 11)


def carrying(*effects: tuple[Effect, float]) -> Model:
    model = BASE
    for effect, amplitude in effects:
        model = model.plus(placed(effect, 0, 1, amplitude))
    generator = np.random.default_rng(2)
    factor = generator.standard_normal((len(model.parameters),) * 2) * 0.01 * abs(model.parameters)[:, None]
    return replace(model, joint_covariance=factor @ factor.T)


def core(p: float) -> ComplexArray:
    return np.asarray(2.0 / (64.0 + 5.0 * p - OMEGA**2 + 1.8j * OMEGA))


def test_effects_that_act_linearly_are_in_it() -> None:
    model = carrying((Delay(), 0.02), (Resonance(frequency=15.0, damping=0.1), 0.7))
    found = linear_response(model, POINTS, OMEGA)
    mode = 0.7 / (15.0**2 - OMEGA**2 + 2j * 0.1 * 15.0 * OMEGA)
    for (p,), response in zip(POINTS, found.response, strict=True):
        np.testing.assert_allclose(response, np.exp(-0.02j * OMEGA) * (core(p) + mode))
    assert found.left_out == ()


def test_effects_on_signals_and_of_measurements_are_left_out_and_named() -> None:
    model = carrying((CubicStiffness(), 3.0), (DriftOfGain(), 5.0), (Delay(), 0.01))
    found = linear_response(model, POINTS, OMEGA)
    np.testing.assert_allclose(found.response[0], np.exp(-0.01j * OMEGA) * core(-1.0))
    assert [effect.kind for effect in found.left_out] == ["cubic_stiffness", "gain_drift"]
    assert found.covariance is not None
    alone = replace(
        BASE,
        effects=model.effects[2:],
        joint_covariance=np.delete(np.delete(model.joint_covariance, (4, 5), 0), (4, 5), 1),
    )
    np.testing.assert_allclose(found.covariance, linear_response(alone, POINTS, OMEGA).covariance)


def test_the_covariance_is_that_of_small_changes_of_all_parameters() -> None:
    model = carrying((Resonance(frequency=15.0, damping=0.1), 0.7), (Delay(), 0.02))
    found = linear_response(model, POINTS, OMEGA).covariance
    assert found is not None
    assert model.joint_covariance is not None
    values, columns = model.parameters, []
    for i, value in enumerate(values):
        step = 1e-6 * abs(value) * (np.arange(len(values)) == i)
        ends = [linear_response(model.with_parameters(values + s * step), POINTS, OMEGA).response for s in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2 * step[i]))
    jacobian = np.stack(columns)
    parts: FloatArray = np.stack([jacobian.real, jacobian.imag], axis=-1)
    expected = np.einsum("kmfi,kl,lmfj->mfij", parts, model.joint_covariance, parts)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * expected.max())


def test_coefficients_heed_the_effects_on_them() -> None:
    model = carrying((QuadraticDependence(coefficient=1), 4.0), (CubicStiffness(), 3.0))
    found = coefficients(model, [(-1.0,), (1.0,), (3.0,)])
    np.testing.assert_allclose(found[:, 1], [59.0 + 4.0, 69.0 - 2.0, 79.0 + 4.0])


def test_without_a_covariance_there_is_none() -> None:
    model = replace(BASE, effects=(placed(Delay(), 0, 1, 0.02),))
    assert linear_response(model, POINTS, OMEGA).covariance is None
    assert linear_response(model, POINTS, OMEGA).response == pytest.approx(
        linear_response(carrying((Delay(), 0.02)), POINTS, OMEGA).response
    )


def test_without_effects_it_is_the_response_of_the_model_itself() -> None:
    known = replace(BASE, covariance=np.diag([0.01, 0.2, 0.1, 0.003]))
    found = linear_response(known, POINTS, OMEGA)
    np.testing.assert_allclose(found.response, known.frequency_response(POINTS, OMEGA)[..., 0, 0])
    np.testing.assert_allclose(found.covariance, known.response_covariance(POINTS, OMEGA)[:, :, 0, 0], atol=1e-18)
