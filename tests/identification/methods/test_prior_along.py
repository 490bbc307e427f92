"""A model from varying scheduling and experiments held still weigh in one fit."""

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT
from identification.errors import MisuseError
from identification.methods.identify import identify
from identification.models.state_space import StateSpaceStructure
from identification.signals import FrequencyResponse
from identification.varying.records import VaryingRecord
from identification.varying.scheduled import affine
from tests.support.varying import PERIOD, turbine

STRUCTURE = StateSpaceStructure(2, 1, 1, 1.0)
HOW = STRUCTURE.over(PLANT.variables, affine(1))
OMEGA, POINT, SHOWN = np.linspace(0.2, 3.0, 30), np.array([[0.9]]), np.array([0.4, 1.1])
DEVIATION = 0.2


def response(seed: int) -> FrequencyResponse:
    g = np.random.default_rng(seed)
    exact = PLANT.frequency_response(POINT, OMEGA)[0, :, 0, 0]
    noise = DEVIATION * g.standard_normal((len(OMEGA), 2)) @ np.array([1, 1j]) / np.sqrt(2)
    return FrequencyResponse(OMEGA, exact + noise, (0.9,), 1.0, np.full(len(OMEGA), DEVIATION**2))


def test_both_count_and_the_covariance_is_that_over_runs() -> None:
    """One operating point alone could not determine the model; together they are known better than from the record."""
    truth, distances, shares = PLANT.frequency_response(POINT, SHOWN)[0, :, 0, 0], [], []
    for seed in range(30):
        along = identify(VaryingRecord(*turbine(seed, 0.5), 1.0, PERIOD), STRUCTURE, HOW).model
        both = identify(response(seed + 100), STRUCTURE, HOW, prior=along)
        assert both.outcome.ok
        assert both.tests[0].p_value > 1e-4
        error = both.model.frequency_response(POINT, SHOWN)[0, :, 0, 0] - truth
        parts, known = np.stack([error.real, error.imag], axis=-1), both.model.response_covariance(POINT, SHOWN)
        distances.append(np.einsum("fi,fij,fj->f", parts, np.linalg.inv(known[0, :, 0, 0]), parts))
        before = along.response_covariance(POINT, SHOWN)[0, :, 0, 0]
        shares.append(np.trace(known[0, :, 0, 0], axis1=-2, axis2=-1) / np.trace(before, axis1=-2, axis2=-1))
    assert np.mean(shares) < 0.9
    assert np.mean(distances) == pytest.approx(2.0, abs=4 * 2 / np.sqrt(30))


def test_a_prior_needs_known_variances_and_the_same_structure() -> None:
    along = identify(VaryingRecord(*turbine(1), 1.0, PERIOD), STRUCTURE, HOW).model
    bare = FrequencyResponse(OMEGA, response(1).response, (0.9,), 1.0)
    with pytest.raises(MisuseError, match="known variances"):
        identify(bare, STRUCTURE, HOW, prior=along)
    other = StateSpaceStructure(1, 1, 1, 1.0)
    with pytest.raises(MisuseError, match="another structure"):
        identify(response(1), other, other.over(PLANT.variables, affine(1)), prior=along)
