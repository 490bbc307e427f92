"""Correlation realisation: a small form of the study, other signals, and what it says about the data."""

import numpy as np
import pytest
from scipy.signal import lfilter

from identification.along import simulate_along
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.varying.correlation_assumptions import A1, A2, A3
from identification.varying.correlation_realisation import CorrelationRealisation
from identification.varying.rates import best_fit_rate, variance_accounted_for
from identification.varying.records import VaryingRecord
from tests.identification.varying.models import output_along
from tests.support.random_state_space import noisy_record, random_affine, slow_record, white_record


@pytest.fixture(scope="module")
def plant():
    return random_affine(np.random.default_rng(12))[0]


def quality(found, held_out):
    simulated = output_along(found.model, held_out.input, held_out.scheduling)
    return best_fit_rate(held_out.output, simulated), variance_accounted_for(held_out.output, simulated)


def test_the_study_in_small(plant):
    record = white_record(plant, np.random.default_rng(1), 5000, 25.0)
    held_out = slow_record(plant, np.random.default_rng(2))
    published = CorrelationRealisation(corrections=0, refinement=False).estimate(record, 4)
    assert quality(published, held_out)[1] > 90
    assert quality(published, held_out)[1] < 99.5
    assert published.model.covariance is None
    reduced = CorrelationRealisation(refinement=False).estimate(record)
    full = CorrelationRealisation(refinement=False, hankel="full").estimate(record)
    for found in (reduced, full):
        assert found.model.structure.order == 4
        assert found.found.parameters == "correlation"
        assert found.outcome.ok
        assert quality(found, held_out)[0] > 95
        assert quality(found, held_out)[1] > 99.9
    assert len(reduced.found.rows) == len(reduced.found.columns) == 10
    assert len(full.found.rows) == 84


def test_noise_free_data_give_the_plant_back(plant):
    record = white_record(plant, np.random.default_rng(3), 3000, np.inf)
    found = CorrelationRealisation().estimate(record, 4)
    held_out = slow_record(plant, np.random.default_rng(2))
    assert quality(found, held_out)[0] > 100 - 1e-5
    assert not any(test.name == A1 for test in found.tests)


@pytest.fixture(scope="module")
def small():
    return random_affine(np.random.default_rng(7), 2, 1, 1, 1)[0]


def drifting_record(model, rng, samples=3000):
    """Coloured input, coloured scheduling."""
    u = lfilter([1.0], [1.0, -0.8], rng.standard_normal((samples, 1)), axis=0)
    p = np.tanh(lfilter([0.5], [1.0, -0.9], rng.standard_normal((samples, 1)), axis=0))
    return noisy_record(model, u, p, rng, 25.0)


def test_signals_that_are_not_white_lead_to_least_squares(small):
    record = drifting_record(small, np.random.default_rng(4))
    held_out = white_record(small, np.random.default_rng(5), 300, np.inf)
    found = CorrelationRealisation().estimate(record, 2)
    assert found.found.parameters == "least_squares"
    assert {test.name for test in found.tests if test.p_value < 1e-3} == {A2, A3}
    assert len(found.found.warnings) == 2
    assert all("found by least squares" in text for text in found.found.warnings)
    assert quality(found, held_out)[1] > 99.8
    full = CorrelationRealisation(hankel="full", refinement=False).estimate(record, 2)
    alike = drifting_record(small, np.random.default_rng(14))
    assert quality(full, alike)[1] > 98
    forced = CorrelationRealisation(parameters="correlation", corrections=0, refinement=False).estimate(record, 2)
    assert "biased" in forced.found.warnings[0]
    unforced = CorrelationRealisation(corrections=0, refinement=False).estimate(record, 2)
    assert quality(unforced, held_out)[1] > quality(forced, held_out)[1] + 5


def test_coloured_noise_is_reported(small):
    rng = np.random.default_rng(6)
    clean = white_record(small, rng, 3000, np.inf)
    noise = 0.05 * np.std(clean.output) * lfilter([1.0], [1.0, -0.7], rng.standard_normal((3000, 1)), axis=0)
    for add, broken in ((noise, {A1}), (0.07 * np.std(clean.output) * rng.standard_normal((3000, 1)), set())):
        record = VaryingRecord(clean.input, clean.output + add, clean.scheduling, 1.0)
        for method in (CorrelationRealisation(), CorrelationRealisation(refinement=False)):
            found = method.estimate(record, 2)
            assert {test.name for test in found.tests if test.p_value < 1e-3} == broken
            assert [text[:22] for text in found.found.warnings] == ["the noise is not white"] * len(broken)


def test_the_covariance_belongs_to_the_model(small):
    record = white_record(small, np.random.default_rng(8), 2000, 20.0)
    found = CorrelationRealisation().estimate(record, 2)
    held_out = white_record(small, np.random.default_rng(9), 100, np.inf)
    error = output_along(found.model, held_out.input, held_out.scheduling) - held_out.output
    deviation = simulate_along(found.model, held_out.input, held_out.scheduling).deviation[:, 0]
    assert 0.3 < np.sqrt(np.mean((error[1:, 0] / deviation[1:]) ** 2)) < 2


def test_it_is_the_same_every_time(small):
    record = white_record(small, np.random.default_rng(10), 500, 20.0)
    one, other = (CorrelationRealisation.example().estimate(record, 2) for _ in range(2))
    assert np.array_equal(one.model.theta, other.model.theta)
    assert np.array_equal(one.found.singular_values, other.found.singular_values)


def test_a_model_that_explains_nothing_says_so(plant):
    record = white_record(plant, np.random.default_rng(11), 300, 0.0)
    found = CorrelationRealisation(corrections=0, refinement=False).estimate(record, 9)
    assert found.outcome.status == "not_converged"
    assert "explains nothing" in found.outcome.advice


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"parameters": "guess"}, "parameters"),
        ({"hankel": "some"}, "hankel"),
        ({"rows": 0}, "rows"),
        ({"columns": 0}, "columns"),
        ({"word_length": 0}, "word_length"),
        ({"word_length": 1, "hankel": "full"}, "word_length"),
        ({"corrections": -1}, "corrections"),
        ({"ridge": -1.0}, "ridge"),
    ],
)
def test_options_that_make_no_sense(options, field):
    with pytest.raises(MisuseError) as error:
        CorrelationRealisation(**options)
    assert error.value.field == field


def test_records_that_do_not_suffice(plant, small):
    record = white_record(plant, np.random.default_rng(11), 600, 20.0)
    with pytest.raises(NotIdentifiableError, match="record four times"):
        CorrelationRealisation(parameters="least_squares").estimate(record, 4)
    still = VaryingRecord(record.input, record.output, 0 * record.scheduling + 1.0, 1.0)
    with pytest.raises(NotIdentifiableError, match="vary every scheduling variable"):
        CorrelationRealisation().estimate(still, 4)
    with pytest.raises(NotIdentifiableError, match="excite every input"):
        CorrelationRealisation().estimate(VaryingRecord(0 * record.input, record.output, record.scheduling, 1.0), 4)
    with pytest.raises(RangeError, match="order"):
        CorrelationRealisation().estimate(record, 0)
    with pytest.raises(RangeError, match="at least that size"):
        CorrelationRealisation().estimate(record, 11)
