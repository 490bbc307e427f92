"""Filtered noise has the designed spectrum on average, from its first sample on, and the spread that is stated."""

import numpy as np
import pytest
from scipy.stats import chi2

from identification.errors import RangeError
from oed.realisation import energy_deviation, filtered_noise, signal_line_energies

RUNS, SAMPLES = 400, 512
C = np.correlate([1.0, 0.5, -0.8, 0.2], [1.0, 0.5, -0.8, 0.2], "full")[3:] * 700.0


@pytest.fixture(scope="module")
def records() -> np.ndarray:
    random = np.random.default_rng(11)
    return np.array([filtered_noise(C, SAMPLES, random) for _ in range(RUNS)])


def test_every_sample_has_the_designed_autocovariance(records: np.ndarray) -> None:
    for lag, c in enumerate(np.append(C, [0.0, 0.0])):
        products = records[:, : SAMPLES - lag] * records[:, lag:]
        for mean, count in ((products.mean(), products.size), (products[:, 0].mean(), RUNS)):
            assert abs(mean - c / SAMPLES) < 5.0 * C[0] / SAMPLES * np.sqrt(8.0 / count)


def test_the_averaged_periodogram_is_the_designed_spectrum(records: np.ndarray) -> None:
    mean = np.mean([signal_line_energies(record) for record in records], axis=0)[1:-1]
    omega = 2.0 * np.pi * np.arange(1, SAMPLES // 2) / SAMPLES
    # Of a finite record: the autocovariances with the weights 1 − i/N.
    weighted = C[1:] * (1.0 - np.arange(1, len(C)) / SAMPLES)
    designed = 2.0 / SAMPLES * (C[0] + 2.0 * np.cos(np.outer(omega, np.arange(1, len(C)))) @ weighted)
    statistic = np.sum(RUNS * (mean / designed - 1.0) ** 2)
    assert chi2.ppf(1e-4, len(omega)) < statistic < chi2.ppf(1.0 - 1e-4, len(omega))


def test_the_energy_is_right_on_average_and_spreads_as_stated(records: np.ndarray) -> None:
    energies = np.sum(records**2, axis=1)
    deviation = energy_deviation(C, SAMPLES)
    assert abs(energies.mean() - C[0]) < 4.0 * deviation / np.sqrt(RUNS)
    assert chi2.ppf(1e-4, RUNS - 1) < RUNS * energies.var() / deviation**2 < chi2.ppf(1.0 - 1e-4, RUNS - 1)


def test_the_deviation_of_white_noise_is_that_of_chi_square() -> None:
    assert energy_deviation([10.0, 0.0], 50) == pytest.approx(10.0 * np.sqrt(2.0 / 50))


@pytest.mark.parametrize("samples", [1, 2, 3, 1000])
def test_the_record_has_the_samples_asked_for(samples: int) -> None:
    assert filtered_noise(C, samples, 0).shape == (samples,)
    assert energy_deviation(C, samples) > 0.0


def test_the_same_generator_state_gives_the_same_record() -> None:
    assert filtered_noise(C, 100, np.random.default_rng(4)).tobytes() == filtered_noise(C, 100, 4).tobytes()


def test_no_samples_are_refused() -> None:
    with pytest.raises(RangeError, match="at least one sample"):
        filtered_noise(C, 0, 0)
