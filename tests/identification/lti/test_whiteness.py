"""Tests of prediction errors hold their level and see what they are for."""

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from identification.lti.initial_conditions import errors_from
from identification.lti.prediction_error import PredictionError
from identification.lti.whiteness import chi_square, input_independence, whiteness
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord

GAIN = RationalStructure(0, 0, sample_time=1.0)


def test_chi_square():
    test = chi_square("name", 12.59, 6)
    assert test.name == "name"
    assert test.p_value == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize(
    ("structure", "slow"), [((1, 0, 1, 0, 1), -0.7), ((1, 0, 1, 0, 1), -0.98), ((0, 0, 0, 1, 1), -0.9)]
)
def test_level_of_both_tests_with_a_coloured_input(structure, slow):
    model = RationalStructure(*structure, sample_time=1.0)
    found = []
    for seed in range(250):
        g = np.random.default_rng([1, seed])
        u = lfilter([1.0], [1.0, -0.9], g.standard_normal(800))
        y = lfilter([0.0, 1.0], [1.0, -0.5], u) if model.n_a else u
        v = lfilter([1.0, 0.5] if model.n_c else [1.0], [1.0, slow], g.standard_normal(800))
        found.append(PredictionError("zero").estimate(model, TimeRecord(u, y + v, 1.0, (0.0,))).tests)
    low, high = stats.binom.interval(0.998, 250, 0.05)
    for tests in zip(*found, strict=True):
        assert low <= sum(test.p_value < 0.05 for test in tests) <= high
        assert 0.42 < np.mean([test.p_value for test in tests]) < 0.58


def test_degrees_of_freedom_lost_to_the_noise_model():
    """A noise model whose responses die out takes one a coefficient; a slow one less; a known one none."""
    structure = RationalStructure(0, 0, n_d=1, sample_time=1.0)
    errors = np.random.default_rng(0).standard_normal(1000)

    def freedom(d, variance):
        return whiteness(structure, np.array([1.0, d]), np.diag([1.0, variance]), errors, 20).degrees_of_freedom

    assert freedom(-0.5, (1 - 0.25) / 1000) == pytest.approx(19, abs=1e-6)
    assert 19 < freedom(-0.99, (1 - 0.9801) / 1000) < 19.8
    assert freedom(-0.5, 0.0) == 20


def test_whiteness_sees_colour():
    errors = np.random.default_rng(0).standard_normal(1000)
    coloured = lfilter([1.0], [1.0, -0.15], errors)
    none = np.zeros((1, 1))
    assert whiteness(GAIN, np.ones(1), none, errors).p_value > 0.01
    assert whiteness(GAIN, np.ones(1), none, coloured).p_value < 0.01
    assert whiteness(GAIN, np.ones(1), none, errors).statistic == pytest.approx(
        whiteness(GAIN, np.ones(1), none, 1e6 * errors).statistic
    )


def test_independence_sees_what_is_left_of_the_input():
    g = np.random.default_rng(0)
    u, e = g.standard_normal((2, 1000))
    for y, expected in ((2 * u + e, True), (2 * u + 0.2 * np.roll(u, 3) + e, False)):
        record = TimeRecord(u, y, 1.0, (0.0,))
        errors, jacobian = errors_from(GAIN, np.array([u @ y / (u @ u)]), record, "zero")
        assert (input_independence(GAIN, errors, jacobian, u).p_value > 0.01) == expected


def test_nothing_to_test():
    assert whiteness(GAIN, np.ones(1), np.zeros((1, 1)), np.zeros(100)) is None
    u = np.ones(100)
    assert input_independence(GAIN, np.random.default_rng(0).standard_normal(100), u[:, None], u, 1) is None
    infinite = np.full((3, 3), np.inf)
    structure = RationalStructure(1, 0, n_d=1, sample_time=1.0)
    assert whiteness(structure, np.zeros(3), infinite, np.random.default_rng(0).standard_normal(100)) is None
