"""Noise on the measured input: no bias, and ellipses that cover the truth as often as they say.

Inputs and outputs are sums of sines and a loop in the time domain; noise is drawn sample by sample.
"""

import numpy as np
import pytest
from scipy import stats
from scipy.signal import freqz, lfilter

from identification.bases.polynomial import Polynomial
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.rational_fit import RationalFit
from identification.measurements.input_errors import InputErrors
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from identification.spectral.periodic_average import PeriodicAverage

STRUCTURE, ZETA = RationalStructure(2, 1, 1, sample_time=1.0), np.array([-1.2, 0.7, 0.5, 0.3])
RUNS = 100


def record(g, zeta=ZETA, p=0.0, periods=8, length=512, lines=200, on_input=0.5, on_output=0.1, shared=0.0):
    """Input rms 1.4, noise of 0.5 on it, of which the share `shared` shows on the output too."""
    spectrum = np.zeros(length // 2 + 1, dtype=complex)
    spectrum[1 : lines + 1] = np.exp(2j * np.pi * g.random(lines))
    spectrum *= 1.4 / np.std(np.fft.irfft(spectrum, n=length))
    omega = 2 * np.pi * np.arange(len(spectrum)) / length
    response = freqz([0, *zeta[2:]], [1, *zeta[:2]], omega)[1]
    u, y = (np.tile(np.fft.irfft(one, n=length), periods) for one in (spectrum, response * spectrum))
    noise = g.standard_normal(len(u))
    y = y + on_output * lfilter([1.0], [1.0, -0.5], g.standard_normal(len(u))) + shared * noise
    return TimeRecord(u + on_input * noise, y, 1.0, (p,), length)


@pytest.mark.parametrize("options", [{}, {"shared": 0.3}, {"on_output": 1.0, "lines": 60, "periods": 12}])
def test_estimates_have_no_bias_and_ellipses_cover_the_truth(options):
    g = np.random.default_rng(3)
    average = PeriodicAverage(drop_periods=0)
    every = [RationalFit().estimate(STRUCTURE, average.estimate(record(g, **options))) for _ in range(RUNS)]
    assert all(one.outcome.ok for one in every)
    off = np.array([one.model.zeta - ZETA for one in every])
    z = np.array([one / np.sqrt(np.diag(e.model.covariance)) for one, e in zip(off, every, strict=True)])
    assert np.all(abs(z.mean(axis=0)) < 0.4)
    assert np.all((z.std(axis=0) > 0.75) & (z.std(axis=0) < 1.25))
    distances = [x @ np.linalg.solve(e.model.covariance, x) for x, e in zip(off, every, strict=True)]
    outside = int(np.sum(np.array(distances) > stats.chi2.ppf(0.95, 4)))
    assert stats.binom.ppf(0.005, RUNS, 0.05) <= outside <= stats.binom.ppf(0.995, RUNS, 0.05)


def test_the_joint_estimate_has_no_bias_either():
    g = np.random.default_rng(4)
    dependence = ParameterDependence(
        (SchedulingVariable("p", "1", 0.0, 1.0),), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0, 0))
    )
    theta = np.array([-1.2, 0.7, 0.1, 0.5, 0.3])
    z = []
    for _ in range(20):
        points = (0.0, 0.5, 1.0)
        records = [record(g, np.array([-1.2, 0.7 + 0.1 * p, 0.5, 0.3]), p) for p in points]
        data = [PeriodicAverage(drop_periods=0).estimate(one) for one in records]
        local = [RationalFit().estimate(STRUCTURE, one) for one in data]
        found = JointLikelihood().estimate(STRUCTURE, dependence, data, local).model
        z.append((found.theta - theta) / np.sqrt(np.diag(found.covariance)))
    assert np.all(abs(np.mean(z, axis=0)) < 0.9)
    assert np.all(np.std(z, axis=0) < 1.6)


def test_an_input_that_repeats_has_no_errors_and_one_with_noise_keeps_them_line_by_line():
    g = np.random.default_rng(5)
    assert PeriodicAverage().estimate(record(g, on_input=0.0)).input_errors is None
    found = PeriodicAverage().estimate(record(g))
    few = found.lines(np.array([3, 5]))
    assert np.all(few.input_errors.input == found.input_errors.input[[3, 5]])


def test_the_sum_over_the_rebuilt_data_has_the_gradient_of_errors_in_both():
    """By differences of Σ|Y − G U|²/s, which nothing here computes, in a direction of G that is free."""
    g = np.random.default_rng(6)

    def complex_normal(size):
        return g.standard_normal(size) + 1j * g.standard_normal(size)

    u, y = complex_normal((9, 30)) + 3, complex_normal((9, 30)) * 0.3 + 2
    errors = InputErrors.of_mean(u, y + 0.4 * u, np.zeros(30), np.zeros(30, dtype=bool))
    response, turn = 0.9 + 0.1 * complex_normal(30), complex_normal(30)

    def cost(e):
        other = response + e * turn
        return float(np.sum(abs(errors.output - other * errors.input) ** 2 / errors.variance(other)))

    data, variance = errors.under(response)
    by_data = -2 * float(np.sum(np.real((data - response).conj() * turn) / variance))
    assert by_data == pytest.approx((cost(1e-5) - cost(-1e-5)) / 2e-5, rel=1e-6)
