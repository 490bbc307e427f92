"""Local polynomials: leakage taken out, variances calibrated, disjoint windows uncorrelated."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from identification.errors import MisuseError, RangeError
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord
from identification.simulation import simulate
from identification.spectral.local_polynomial import LocalPolynomial
from tests.support.loops import SLOW, in_loop, proportional

PLANT = RationalStructure(2, 1, 1, sample_time=0.1), np.array([-1.5, 0.7, 1.0, 0.5])
NOISE = RationalStructure(0, 0, n_c=1, n_d=1, sample_time=0.1), np.array([0.0, 0.3, -0.6])


def record(generator: np.random.Generator, samples: int, noise: float) -> TimeRecord:
    u = generator.normal(size=samples)
    y = simulate(*PLANT, u) + simulate(*NOISE, u, noise * generator.normal(size=samples))
    return TimeRecord(u, y, 0.1, (2.0,))


def true(data):
    return PLANT[0].plant_response(PLANT[1], data.frequencies)


def test_leakage_is_taken_out():
    one = record(np.random.default_rng(0), 4096, 0.0)
    data = LocalPolynomial(stride=1).estimate(one)
    assert len(data) > 2000
    plain = (np.fft.rfft(one.output) / np.fft.rfft(one.input))[1:2048]
    at = np.round(data.frequencies * 4096 * 0.1 / (2 * np.pi)).astype(int) - 1
    error, leaking = abs(data.response - true(data)), abs(plain[at] - true(data))
    assert np.sqrt(np.mean(error**2)) < 1e-3 * np.sqrt(np.mean(leaking**2))


def test_a_plant_and_a_transient_that_are_polynomials_are_found_exactly():
    generator = np.random.default_rng(1)
    f = np.arange(257) / 256
    spectrum = generator.normal(size=257) + 1j * generator.normal(size=257)
    plant, transient = 1 - 2j * f + 0.5 * f**2, 30 + 4j * f - 9 * f**2
    u = np.fft.irfft(spectrum)
    y = np.fft.irfft(plant * spectrum + transient)
    data = LocalPolynomial(stride=1).estimate(TimeRecord(u, y, 1.0, (0.0,)))
    at = np.round(data.frequencies * 512 / (2 * np.pi)).astype(int)
    np.testing.assert_allclose(data.response, plant[at], rtol=1e-8)


def test_the_variance_is_calibrated_and_disjoint_windows_are_uncorrelated():
    generator = np.random.default_rng(2)
    ratios, neighbours = [], []
    for _ in range(150):
        data = LocalPolynomial().estimate(record(generator, 2000, 0.5))
        error = (data.response - true(data)) / np.sqrt(data.variance)
        ratios.append(abs(error) ** 2)
        neighbours.append(np.real(error[1:] * error[:-1].conj()))
    assert data.variance_degrees_of_freedom == 7
    assert np.mean(ratios) == pytest.approx(7 / 6, rel=0.04)
    assert np.mean(np.array(ratios) > stats.f.ppf(0.95, 2, 14)) == pytest.approx(0.05, abs=0.01)
    assert abs(np.mean(neighbours)) < 4 * np.std(neighbours) / np.sqrt(np.size(neighbours))


def test_neighbouring_lines_of_one_window_are_correlated():
    generator = np.random.default_rng(3)
    data = LocalPolynomial(stride=1).estimate(record(generator, 4000, 0.5))
    error = (data.response - true(data)) / np.sqrt(data.variance)
    assert np.mean(np.real(error[1:] * error[:-1].conj())) > 0.3


def test_lines_without_input_are_left_out():
    generator = np.random.default_rng(4)
    one = record(generator, 2048, 0.1)
    spectrum = np.fft.rfft(one.input)
    spectrum[400:] = 0
    u = np.fft.irfft(spectrum)
    data = LocalPolynomial(stride=1).estimate(replace(one, input=u, output=simulate(*PLANT, u)))
    assert data.frequencies.max() < 2 * np.pi * 400 / 204.8


def test_a_periodic_record_from_rest_is_calibrated_too():
    """With a transient that averaging over all periods would take for plant."""
    generator = np.random.default_rng(6)
    ratios = []
    for _ in range(60):
        u = np.tile(generator.normal(size=512), 4)
        y = simulate(*PLANT, u) + simulate(*NOISE, u, 0.2 * generator.normal(size=len(u)))
        data = LocalPolynomial().estimate(TimeRecord(u, y, 0.1, (0.0,), 512))
        at = data.frequencies * 51.2 / (2 * np.pi)
        np.testing.assert_allclose(at, np.round(at), atol=1e-9)
        ratios.append(abs(data.response - true(data)) ** 2 / data.variance)
    assert data.variance_degrees_of_freedom == 49 - 6
    assert np.mean(ratios) == pytest.approx(43 / 42, rel=0.1)


def test_what_cannot_be_estimated_is_refused():
    one = record(np.random.default_rng(5), 200, 0.1)
    with pytest.raises(MisuseError, match="record longer"):
        LocalPolynomial(half_window=60).estimate(one)
    with pytest.raises(MisuseError, match="constant"):
        LocalPolynomial().estimate(replace(one, input=np.zeros(200)))
    pulse = np.zeros(200)
    pulse[0] = 1.0
    with pytest.raises(MisuseError, match="too smooth"):
        LocalPolynomial().estimate(replace(one, input=pulse))
    for wrong in ({"half_window": 2}, {"degree": -1}, {"stride": 0}, {"threshold": -0.1}):
        with pytest.raises(RangeError):
            LocalPolynomial(**wrong)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), c=st.sampled_from([-1e-6, 0.5, 1e9]), d=st.sampled_from([-1e3, 1e-9]))
def test_units_of_the_signals(seed, c, d):
    one = record(np.random.default_rng(seed), 500, 0.1)
    scaled = replace(one, input=c * one.input, output=d * one.output, sample_time=1e-6)
    a, b = LocalPolynomial().estimate(one), LocalPolynomial().estimate(scaled)
    np.testing.assert_allclose(b.response, d / c * a.response, rtol=1e-9)
    np.testing.assert_allclose(b.variance, (d / c) ** 2 * a.variance, rtol=1e-6)


def test_with_the_reference_of_a_loop_feedback_of_noise_leaves_no_bias():
    """Without it the error is several times the stated one."""
    record = in_loop(5, SLOW, proportional(1.0), feedback=True, reference=True, size=0.3)
    found = [LocalPolynomial().estimate(one) for one in (record, replace(record, reference=None))]
    z = []
    for one in found:
        q = np.exp(-1j * one.frequencies)
        z.append(abs(one.response - 0.5 * q / (1 - 0.95 * q)) ** 2 / one.variance)
    assert len(z[0]) > 100
    assert np.median(z[0]) / np.log(2) == pytest.approx(1.0, abs=0.35)
    assert np.mean(z[1]) > 3 * np.mean(z[0])


def test_lines_that_the_reference_hardly_moves_are_left_out():
    record = in_loop(5, SLOW, proportional(1.0), feedback=True, reference=True)
    found = [LocalPolynomial().estimate(one) for one in (record, replace(record, reference=None))]
    assert len(found[0]) < 0.2 * len(found[1])
