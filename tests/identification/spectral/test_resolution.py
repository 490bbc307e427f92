"""Steps of converters are found and their rounding counts as noise; sensors that show no plant are refused by name."""

import numpy as np
import pytest

from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.errors import MisuseError
from identification.signals import TimeRecord
from identification.spectral.local_polynomial import LocalPolynomial
from identification.spectral.periodic_average import PeriodicAverage
from identification.spectral.resolution import converter_step, repeated_error, require_changing
from tests.support.oscillators import MODEL, PERIOD, SAMPLE_TIME, clean_records

RAMP = np.cumsum(np.random.default_rng(0).standard_normal(4000)) / 40


@pytest.mark.parametrize("step", [0.5, 0.02, 0.005])
@pytest.mark.parametrize("offset", [0.0, 1e4])
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_the_step_is_found_with_noise_behind_the_converter_and_with_an_offset(step, offset, noise):
    scatter = noise * step * np.random.default_rng(1).standard_normal(len(RAMP))
    found = converter_step(step * np.round(RAMP / step) + scatter + offset)
    assert found == pytest.approx(step, rel=1e-2)


@pytest.mark.parametrize(
    "signal",
    [RAMP, np.sin(RAMP), np.sign(RAMP), np.random.default_rng(2).random(3000), np.ones(100), RAMP[:30]],
)
def test_signals_without_a_grid_have_no_step(signal):
    assert converter_step(signal) == 0.0


def test_rounding_repeats_unless_noise_dithers_it():
    """Monte Carlo: the covariance of the rounding errors of the same value with two draws of noise."""
    g = np.random.default_rng(3)
    value = g.random(20000) * 50
    for sigma in (0.02, 0.2, 0.6):
        errors = [np.round(value + n) - value - n for n in sigma * g.standard_normal((2, 20000))]
        assert np.mean(errors[0] * errors[1]) == pytest.approx(repeated_error(1.0, sigma), abs=0.01)
    assert repeated_error(0.0, 1.0) == 0.0


def test_a_coarse_converter_is_no_misfit_and_its_step_is_said():
    rounded = [
        TimeRecord(r.input, 0.02 * np.round(r.output / 0.02), SAMPLE_TIME, r.operating_point, PERIOD)
        for r in clean_records(3, sigma=1e-5)
    ]
    found = compare(MODEL, gather(rounded))
    assert found.overall.p_value > 1e-3
    assert found.overall.statistic > 0.3 * found.overall.degrees_of_freedom
    assert "0.02" in found.notes[0][1]
    response = PeriodicAverage().estimate(rounded[0])
    model = MODEL.frequency_response([rounded[0].operating_point], response.frequencies)[0, :, 0, 0]
    z = abs(response.response - model) ** 2 / response.variance
    assert 0.3 < np.mean(z) < 3


STUCK = {
    "stands": lambda y, g: np.full(len(y), 5.3),
    "flickers": lambda y, g: 5.3 + 0.0024 * (g.random(len(y)) < 0.4),
    "froze": lambda y, g: np.concatenate([y[: len(y) // 2], np.full(len(y) - len(y) // 2, y[len(y) // 2])]),
}


@pytest.mark.parametrize("kind", STUCK)
def test_what_does_not_change_is_refused_with_the_number_of_the_experiment(kind):
    good = clean_records(1)
    g = np.random.default_rng(4)
    bad = TimeRecord(good[1].input, STUCK[kind](good[1].output, g), SAMPLE_TIME, good[1].operating_point, PERIOD)
    with pytest.raises(MisuseError, match=r"experiment 2, at -0.5: the output"):
        gather([good[0], bad])
    for estimator in (PeriodicAverage(), LocalPolynomial(half_window=3)):
        with pytest.raises(MisuseError, match="the output"):
            estimator.estimate(bad)


def test_a_relay_that_follows_its_input_a_dead_zone_and_a_plant_at_rest_are_measurements():
    g = np.random.default_rng(5)
    u = g.standard_normal(400)
    late = np.concatenate([np.zeros(150), u[:-150]])
    for y in (np.sign(u), np.where(abs(u) > 0.5, u, 0.0), late, np.concatenate([[0.0, 0.0], np.sign(u)[:-2]])):
        require_changing(TimeRecord(u, y, 1.0, (0.0,)))
