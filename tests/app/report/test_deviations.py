"""The stated deviations of poles are those that poles of drawn parameters have."""

from dataclasses import replace

import numpy as np
import pytest

from app.report.deviations import local_poles, poles_of
from identification.arrays import FloatArray
from identification.models.model import LocalModel, Model
from tests.app.report.models import POINTS, resonance


@pytest.mark.parametrize("sample_time", [0.5, None])
def test_deviations_are_those_of_drawn_models(sample_time: float | None) -> None:
    model = resonance(sample_time)
    found = poles_of(model, POINTS)
    draws = np.random.default_rng(1).multivariate_normal(model.theta, model.covariance, 4000)
    values = np.array([np.sort_complex(_with(model, theta).poles(POINTS[::10])) for theta in draws])
    np.testing.assert_allclose(found.real_deviation[::10], values.real.std(axis=0), rtol=0.06)
    np.testing.assert_allclose(found.imaginary_deviation[::10], values.imag.std(axis=0), rtol=0.06)


def test_poles_are_ordered_and_those_of_the_model() -> None:
    model = resonance()
    found = poles_of(model, POINTS)
    np.testing.assert_allclose(found.values, np.sort_complex(model.poles(POINTS)))
    assert np.all(found.values[:, 0].imag < 0)
    assert np.all(found.values[:, 1].imag > 0)


def test_a_local_model_has_the_deviations_of_the_whole_model_there() -> None:
    model, point = resonance(), (1.0,)
    transfer = model.dependence.matrix([point])[0]
    local = LocalModel(
        model.structure, point, transfer @ model.theta, transfer @ model.covariance @ transfer.T, model.noise_variance
    )
    whole, own = poles_of(model, [point]), local_poles(local)
    np.testing.assert_allclose(own.values, whole.values)
    np.testing.assert_allclose(own.real_deviation, whole.real_deviation)
    np.testing.assert_allclose(own.imaginary_deviation, whole.imaginary_deviation)


def _with(model: Model, theta: FloatArray) -> Model:
    return replace(model, theta=theta)
