"""Every target against its definition: P⁻¹ ⪰ R just when the covariance keeps what was asked for."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.model import Model
from oed.targets.local_covariance import LocalCovariance
from oed.targets.parameter_deviation import ParameterDeviation
from oed.targets.response_deviation import ResponseDeviation
from tests.support.random_models import paper_model, random_model

SEEDS = pytest.mark.parametrize("seed", range(5))


def random_covariance(model: Model, seed: int) -> np.ndarray:
    k, plant = model.dependence.size, model.plant_size
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(k, k)) * rng.uniform(0.2, 2, size=(k, 1))
    factor[:plant, plant:] = factor[plant:, :plant] = 0
    return np.asarray(factor @ factor.T + 1e-3 * np.eye(k))


def met(covariance: np.ndarray, matrices: np.ndarray) -> bool:
    return bool(np.all(np.linalg.eigvalsh(np.linalg.inv(covariance) - matrices) >= -1e-9))


@SEEDS
def test_single_standard_deviations(seed: int) -> None:
    model = random_model(np.random.default_rng(seed))
    covariance = random_covariance(model, seed)
    deviations = np.sqrt(np.diagonal(covariance))
    for factor, expected in ((1.001, True), (0.999, False)):
        target = ParameterDeviation(tuple(factor * deviations), jointly=False)
        assert met(covariance, target.matrices(model)) is expected


@SEEDS
def test_all_standard_deviations_jointly(seed: int) -> None:
    model = random_model(np.random.default_rng(seed))
    covariance = random_covariance(model, seed)
    sigma = np.random.default_rng(seed).uniform(0.5, 2, size=model.dependence.size)
    largest = np.sqrt(np.linalg.eigvalsh(covariance / np.outer(sigma, sigma))[-1])
    for factor, expected in ((1.001, True), (0.999, False)):
        matrices = ParameterDeviation(tuple(factor * largest * sigma)).matrices(model)
        assert met(covariance, matrices) is expected
    assert np.linalg.matrix_rank(matrices[0]) == model.dependence.size


@SEEDS
def test_covariance_of_local_parameters(seed: int) -> None:
    model = random_model(np.random.default_rng(seed))
    covariance = random_covariance(model, seed)
    plant = model.structure.n_plant
    transfer = model.dependence.matrix([[1.3]])[0]
    local = transfer @ covariance @ transfer.T
    for factor, expected in ((1.001, True), (0.999, False)):
        everything = LocalCovariance(((1.3,),), tuple(map(tuple, factor * local))).matrices(model)
        assert met(covariance, everything) is expected
        plant_only = LocalCovariance(((1.3,),), tuple(map(tuple, factor * local[:plant, :plant]))).matrices(model)
        assert met(covariance, plant_only) is expected


@SEEDS
@pytest.mark.parametrize("relative", [True, False])
def test_deviation_of_the_frequency_response(seed: int, relative: bool) -> None:
    model = random_model(np.random.default_rng(seed))
    model = replace(model, covariance=random_covariance(model, seed))
    omega = np.geomspace(0.1, 3.0, 7)
    points = [[0.0], [2.5]]
    response = model.response_covariance(points, omega)[:, :, 0, 0]
    worst = np.sqrt(np.linalg.eigvalsh(response)[..., -1])
    largest = np.max(worst / abs(model.frequency_response(points, omega)[..., 0, 0]) if relative else worst)
    for factor, expected in ((1.001, True), (0.999, False)):
        target = ResponseDeviation(((0.0,), (2.5,)), 0.1, 3.0, factor * largest, relative, count=7)
        assert met(model.covariance, target.matrices(model)) is expected


def test_a_parameter_may_be_left_out() -> None:
    matrices = ParameterDeviation((0.1, None, 0.2, None, None, None)).matrices(paper_model())
    assert np.diagonal(matrices[0]) == pytest.approx([100, 0, 25, 0, 0, 0])


MIDDLE = ((4.0,),)


@pytest.mark.parametrize(
    ("target", "error", "words"),
    [
        (ParameterDeviation((0.1,)), ShapeError, "6 parameters"),
        (ParameterDeviation((None,) * 6), RangeError, "at least one"),
        (ParameterDeviation((0.1, -0.1, None, None, None, None)), RangeError, "positive"),
        (LocalCovariance(MIDDLE, ((1.0,),)), ShapeError, "size 3"),
        (LocalCovariance(MIDDLE, ((1.0, 0.0), (0.0,))), ShapeError, "square"),
        (LocalCovariance(MIDDLE, ((1.0, 2.0), (2.0, 1.0))), RangeError, "definite"),
        (LocalCovariance(MIDDLE, ((1.0, 0.5), (0.4, 1.0))), RangeError, "symmetric"),
        (LocalCovariance(((9.0,),), ((1.0, 0.0), (0.0, 1.0))), RangeError, "outside its range"),
        (ResponseDeviation(MIDDLE, 0.1, 4.0, 0.1), RangeError, "Nyquist"),
        (ResponseDeviation(MIDDLE, 2.0, 1.0, 0.1), RangeError, "rise"),
        (ResponseDeviation(MIDDLE, 0.1, 1.0, 0.0), RangeError, "positive"),
        (ResponseDeviation(MIDDLE, 0.1, 1.0, 0.1, count=0), RangeError, "number of frequencies"),
    ],
)
def test_targets_that_make_no_sense(target: ParameterDeviation, error: type[MisuseError], words: str) -> None:
    with pytest.raises(error, match=words):
        target.matrices(paper_model())
