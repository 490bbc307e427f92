"""Over many runs the stated covariance is the true one, and the tests reject as often as they say."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from identification.arrays import FloatArray
from identification.estimates import LocalEstimate
from identification.lti.rational_fit import RationalFit
from identification.lti.response_tests import variance_inflation
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, TimeRecord
from identification.simulation import simulate
from identification.spectral.local_polynomial import LocalPolynomial
from identification.spectral.periodic_average import PeriodicAverage

RUNS = 300
CONTINUOUS = RationalStructure(2, 1), np.array([1.2, 4.0, 1.0, 3.0])
DISCRETE = RationalStructure(2, 1, 1, sample_time=0.1), np.array([-1.5, 0.7, 1.0, 0.5])
NOISE = RationalStructure(0, 0, n_c=1, n_d=1, sample_time=0.1), np.array([0.0, 0.3, -0.6])


def within_binomial_interval(rejections: int, level: float, runs: int = RUNS) -> bool:
    low, high = stats.binom.interval(0.99, runs, level)
    return bool(low <= rejections <= high)


def distance(estimate: LocalEstimate, zeta: FloatArray) -> float:
    error = estimate.model.zeta - zeta
    return float(error @ np.linalg.solve(estimate.model.covariance, error))


def circular(generator: np.random.Generator, size: int) -> np.ndarray:
    return (generator.normal(size=size) + 1j * generator.normal(size=size)) / np.sqrt(2)


def draws(kind: str, runs: int) -> list[LocalEstimate]:
    """Estimates of the continuous plant from independent noise of known variance, or of unknown scale."""
    structure, zeta = CONTINUOUS
    generator = np.random.default_rng(11)
    omega = np.geomspace(0.1, 30, 40)
    true = structure.plant_response(zeta, omega)
    spread = np.full(40, 0.02) if kind == "absolute" else 0.02 * abs(true)
    known = kind in ("variance", "sandwich")
    fit = RationalFit(weighting="absolute" if kind == "sandwich" else kind)
    found = []
    for _ in range(runs):
        noisy = true + spread * circular(generator, 40)
        data = FrequencyResponse(omega, noisy, (0.0,), None, spread**2 if known else None)
        found.append(fit.estimate(structure, data))
    return found


@pytest.mark.parametrize("kind", ["variance", "sandwich", "relative", "absolute"])
def test_the_covariance_is_true(kind):
    estimates = draws(kind, RUNS)
    limit = stats.chi2.ppf(0.95, 4) if kind in ("variance", "sandwich") else 4 * stats.f.ppf(0.95, 4, 76)
    distances = np.array([distance(estimate, CONTINUOUS[1]) for estimate in estimates])
    assert all(estimate.outcome.ok for estimate in estimates)
    assert within_binomial_interval(int(np.sum(distances > limit)), 0.05)
    for name in {test.name for test in estimates[0].tests}:
        p_values = [test.p_value for estimate in estimates for test in estimate.tests if test.name == name]
        assert within_binomial_interval(int(np.sum(np.array(p_values) < 0.05)), 0.05), name
    if kind in ("relative", "absolute"):
        scales = [estimate.model.noise_variance for estimate in estimates]
        assert np.mean(scales) == pytest.approx(0.02**2, rel=0.03)


def periodic_record(generator: np.random.Generator, periods: int, gain: float = 1.0) -> TimeRecord:
    """A steady record of the discrete plant with a random-phase input and coloured output noise."""
    structure, zeta = DISCRETE
    lines = np.exp(2j * np.pi * generator.uniform(size=65))
    lines[[0, -1]] = 1.0
    u = np.tile(np.fft.irfft(lines) * 16, periods)
    y = simulate(structure, zeta, u, periodic=True)
    noise = simulate(*NOISE, u, 0.3 * gain * generator.normal(size=len(u)))
    return TimeRecord(u, y + noise, 0.1, (0.0,), 128)


def test_with_variances_from_few_periods_the_covariance_is_inflated_as_needed():
    structure, zeta = DISCRETE
    generator = np.random.default_rng(5)
    average = PeriodicAverage(drop_periods=0)
    estimates = [
        RationalFit().estimate(structure, average.estimate(periodic_record(generator, 7))) for _ in range(RUNS)
    ]
    distances = np.array([distance(estimate, zeta) for estimate in estimates])
    assert within_binomial_interval(int(np.sum(distances > stats.chi2.ppf(0.95, 4))), 0.05)
    assert np.mean(distances) == pytest.approx(4, rel=0.12)
    assert variance_inflation(6.0) == pytest.approx(1.5)
    for name in ("lack of fit", "whiteness over frequency"):
        p_values = np.array([t.p_value for e in estimates for t in e.tests if t.name == name])
        assert within_binomial_interval(int(np.sum(p_values < 0.05)), 0.05), name


def test_a_fit_to_local_polynomials_has_a_true_covariance():
    structure, zeta = DISCRETE
    generator = np.random.default_rng(6)
    runs, distances = 200, []
    for _ in range(runs):
        u = generator.normal(size=2000)
        y = simulate(structure, zeta, u) + simulate(*NOISE, u, 0.5 * generator.normal(size=2000))
        estimate = RationalFit().estimate(structure, LocalPolynomial().estimate(TimeRecord(u, y, 0.1, (0.0,))))
        distances.append(distance(estimate, zeta))
    assert within_binomial_interval(int(np.sum(np.array(distances) > stats.chi2.ppf(0.95, 4))), 0.05, runs)


def test_a_missing_pole_is_seen_by_both_tests():
    structure, zeta = CONTINUOUS
    omega = np.geomspace(0.1, 30, 60)
    true = structure.plant_response(zeta, omega)
    spread = 0.01 * abs(true)
    data = FrequencyResponse(omega, true + spread * circular(np.random.default_rng(0), 60), (0.0,), None, spread**2)
    wrong = RationalFit().estimate(RationalStructure(1, 0), data)
    assert {test.name for test in wrong.tests} == {"lack of fit", "whiteness over frequency"}
    assert all(test.p_value < 1e-6 for test in wrong.tests)
    alternating = replace(data, response=true + spread * np.where(np.arange(60) % 2, 1, -1))
    assert RationalFit().estimate(structure, alternating).tests[1].p_value < 1e-6
