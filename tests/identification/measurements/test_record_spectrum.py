"""Amplitudes of lines and of noise are what was put into a record."""

import numpy as np
import pytest

from identification.measurements.record_spectrum import record_spectrum
from identification.signals import TimeRecord

L, STEP = 200, 0.1


def record(periods: int, noise: float, stated: bool = True) -> TimeRecord:
    generator = np.random.default_rng(3)
    t = np.arange(periods * L)
    u = 3.0 * np.cos(2 * np.pi * 7 * t / L) + 0.5 * np.cos(2 * np.pi * 31 * t / L + 1) + 0.25
    y = 2.0 * np.sin(2 * np.pi * 7 * t / L) + 1.0 + noise * generator.standard_normal(len(t))
    return TimeRecord(u, y, STEP, (0.0,), L if stated else None)


@pytest.mark.parametrize("stated", [True, False])
def test_amplitudes_and_lines(stated: bool) -> None:
    found = record_spectrum(record(4, 0.0, stated))
    assert found.periods == 4
    np.testing.assert_array_equal(np.flatnonzero(found.excited), [0, 7, 31])
    np.testing.assert_allclose(found.input[[0, 7, 31]], [0.25, 3.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(found.output[[0, 7, 31]], [1.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(found.frequencies[7], 2 * np.pi * 7 / (L * STEP))


def test_the_noise_is_that_of_the_mean_over_periods() -> None:
    found = record_spectrum(record(50, 0.3))
    assert found.noise is not None
    expected = 0.3 * np.sqrt(4 / (L * 50))
    assert np.sqrt(np.mean(found.noise[1:-1] ** 2)) == pytest.approx(expected, rel=0.05)


def test_one_period_says_nothing_of_the_noise() -> None:
    generator = np.random.default_rng(1)
    noise = TimeRecord(generator.standard_normal(1001), generator.standard_normal(1001), STEP, (0.0,))
    found = record_spectrum(noise)
    assert found.noise is None
    assert len(found.frequencies) == 501


def test_of_many_lines_the_outstanding_are_kept() -> None:
    whole, part = record_spectrum(record(4, 0.01)), record_spectrum(record(4, 0.01), most=20)
    assert len(part.frequencies) == 20
    assert set(part.frequencies) <= set(whole.frequencies)
    np.testing.assert_array_equal(part.frequencies[part.excited], whole.frequencies[whole.excited])
