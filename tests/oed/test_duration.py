"""The duration rule, and the records without input that it may need."""

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.scheduling import ProductBasis
from oed.design import design
from oed.duration import required_samples, supplementary_points
from oed.information import noise_information
from oed.problem import DesignProblem
from oed.spectra.fir import FirSpectra
from oed.targets.parameter_deviation import ParameterDeviation
from tests.support.random_models import paper_model


def test_the_largest_ratio_counts() -> None:
    information = np.array([np.diag([1.0, 4.0]), np.diag([1.0, 0.0])])
    assert required_samples(information, np.array([np.diag([10.0, 4.0]), np.diag([0.0, 12.0])])) == pytest.approx(5)
    assert required_samples(information, np.zeros((1, 2, 2))) == 0
    assert required_samples(information[1:], np.array([np.diag([1.0, 1.0])])) == np.inf


def curved_noise() -> Model:
    """The example of the paper with a noise model that needs three operating points, its plant needing two."""
    model = paper_model()
    bases = (*model.dependence.bases[:2], ProductBasis((Polynomial(2),)))
    dependence = type(model.dependence)(model.dependence.variables, bases)
    theta = np.append(model.theta, 0.001)
    return Model(model.structure, dependence, theta, np.zeros((7, 7)), 0.5)


def test_records_without_input_are_asked_for_where_the_noise_model_needs_them() -> None:
    model = curved_noise()
    target = ParameterDeviation((0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.1, 0.05, 0.02))
    points = np.array([[0.0], [5.5]])
    short = design(DesignProblem(model, points, (target,), FirSpectra(10), 1000))
    assert short.outcome.status == "infeasible"
    assert "allow more operating points" in short.outcome.advice
    caps = np.array([1e9, 1e-9, 1e9])
    wider = design(DesignProblem(model, np.array([[0.0], [3.0], [5.5]]), (target,), FirSpectra(10), 1000, caps))
    assert wider.outcome.status == "infeasible"
    assert "record without input at (3) as well" in wider.outcome.advice


def test_the_points_asked_for_suffice() -> None:
    model = curved_noise()
    grid = np.arange(0, 9.0)[:, None]
    information = noise_information(model, grid)
    wanted = np.diag([100.0, 400.0, 2500.0])[None]
    known = information[0]
    chosen = supplementary_points(information, known, wanted)
    assert len(set(chosen)) == 2
    assert np.isfinite(required_samples(np.stack([known, *information[chosen]]), wanted))
