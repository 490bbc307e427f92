"""Noise variances of mean spectra: unbiased for steep spectra, pooled alike everywhere, with their own freedom."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import kstest

from identification.comparison.gather import gather
from identification.comparison.lack_of_fit import lack_of_fit
from identification.comparison.noise import (
    noise_freedom,
    noise_of_mean,
    pooled,
    spread_back,
    variance_of_projection,
)
from identification.extension.rows import Rows
from identification.signals import TimeRecord
from tests.support.oscillators import batches


def noise_alone(seed, pole, period=256, count=4, records=4):
    """Records of nothing but noise of an autoregression."""
    g = np.random.default_rng(seed)
    u = np.tile(np.sin(2 * np.pi * 3 * np.arange(period) / period), count)
    noise = lfilter([1.0], [1.0, -pole], g.standard_normal((records, period * count + 100)))[:, 100:]
    return Rows(gather([TimeRecord(u, y, 0.5, (0.0,), period) for y in noise]))


def energies(pole, runs=150):
    found = []
    for seed in range(runs):
        rows = noise_alone(seed, pole)
        energy = sum(float(np.sum(batch.whiten(batch.outputs) ** 2)) for batch in rows.batches)
        found.append((energy, rows.count, rows.noise_freedom))
    return found


@pytest.mark.parametrize("pole", [0.0, 0.9, -0.8])
def test_residuals_of_coloured_noise_have_unit_variance_and_lack_of_fit_is_uniform(pole):
    """A window over the steep spectrum, or its leakage left in, makes every p too large."""
    found = energies(pole)
    assert np.mean([energy / count for energy, count, _ in found]) == pytest.approx(1.0, abs=0.012)
    assert kstest([lack_of_fit("", *one).p_value for one in found], "uniform").pvalue > 5e-3


@pytest.mark.parametrize("pole", [0.9, -0.8])
def test_what_leaves_the_record_at_its_end_makes_no_jump_between_the_periods(pole):
    """Unless it is allowed for, the jump at the end of the mean period has three times the variance of white noise."""
    jumps = np.sign(pole) ** np.arange(256) * (pole ** np.arange(256.0) - abs(pole) ** np.arange(255.0, -1, -1))
    found = []
    for seed in range(100):
        for batch in noise_alone(seed, pole).batches:
            rows = batch.whiten(batch.outputs).reshape(len(batch.points), -1)
            shape = batch.whiten(np.tile(batch.spectrum(jumps), (len(rows), 1))).reshape(rows.shape)
            found.append(np.sum(rows * shape, axis=1) / np.linalg.norm(shape, axis=1))
    assert np.var(np.concatenate(found)) == pytest.approx(1.0, abs=0.25)


REAL = np.arange(40) == 0


@pytest.mark.parametrize("cycles", [12.5, 12.37])
def test_hum_beside_the_lines_of_the_period_leaves_the_noise_as_it_is(cycles):
    """Folded once, the covariance of a sine between the lines goes negative, and lines got no variance at all."""
    g = np.random.default_rng(8)
    time = np.arange(1024) / 256
    u = np.tile(np.sin(2 * np.pi * 3 * np.arange(256) / 256), 4)
    noise = 0.01 * g.standard_normal((40, 1024))
    quiet, loud = (
        gather([TimeRecord(u, n + a * np.sin(2 * np.pi * cycles * time + n[0] * 99), 0.5, (0.0,), 256) for n in noise])
        for a in (0.0, 1.0)
    )
    ratio = loud[0].variances / quiet[0].variances
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.03)
    assert np.all((ratio > 0.6) & (ratio < 1.6))
    energy = np.sum(loud[0].whiten(loud[0].outputs) ** 2) / loud[0].row_count
    assert energy == pytest.approx(1.0, abs=0.06)


def test_a_spectrum_too_steep_for_the_periods_never_gives_a_line_without_noise():
    """A narrow line at every period with its own size: nothing that the autoregression gives is negative or nought."""
    g = np.random.default_rng(2)
    time = np.arange(256) / 256
    periods = np.stack([a * np.sin(2 * np.pi * 20.5 * time) for a in g.standard_normal(4)])
    found = noise_of_mean(np.fft.rfft(periods) / 256, np.arange(129) % 128 == 0)
    pooled_spread = np.var(np.fft.rfft(periods) / 256, axis=0, ddof=1).mean() / 4
    assert np.all(found.variance > 1e-6 * pooled_spread)


def test_short_periods_are_pooled_as_they_are():
    errors = np.random.default_rng(0).standard_normal((3, 9)) + 0j
    found = noise_of_mean(errors, np.arange(9) % 8 == 0)
    assert (found.freedom, found.half_width) == (2.0 * 2 * 7, 3)
    assert np.allclose(found.variance, found.variance[1] * np.where(np.arange(9) % 8 == 0, 2, 1))


def test_every_window_holds_as_many_lines_and_no_real_one():
    values = np.zeros(40)
    values[1] = 1.0
    assert np.allclose(pooled(np.ones(40), 7, REAL), 1.0)
    assert np.count_nonzero(pooled(values, 7, REAL)) == 9
    assert np.all(pooled(1.0 * REAL, 7, REAL) == 0)


def test_spreading_back_is_the_adjoint_of_pooling():
    g = np.random.default_rng(1)
    x, w = g.random(40), g.random((3, 40))
    assert np.allclose(w @ pooled(x, 7, REAL), spread_back(w, 7, REAL) @ x)


def test_few_periods_give_student_not_normal():
    """The window's degrees of freedom for a signature in one place, all of them for one that is everywhere."""
    (batch,) = batches()
    one, all_lines = np.zeros((2, len(batch.compared)))
    one[20] = 1.0
    all_lines[:] = batch.compared / batch.row_count
    everything = batch.raw_freedom * np.isfinite(batch.variances).sum()
    assert noise_freedom([batch], [one]) == pytest.approx(batch.raw_freedom * (2 * batch.half_width + 1), rel=0.01)
    assert 0.8 * everything < noise_freedom([batch], [all_lines]) <= everything
    known = replace(batch, raw_freedom=np.inf, freedom=np.inf)
    assert noise_freedom([known], [one]) == np.inf


@pytest.mark.parametrize(("lines", "freedom"), [(1, 30.0), (6, 30.0), (60, 30.0), (60, np.inf)])
def test_a_projection_has_more_variance_where_many_weights_are_random(lines, freedom):
    """Drawn: noise over its estimated deviation, along a change that was whitened by the same estimates."""
    (batch,) = batches(0)
    batch = replace(batch, freedom=freedom, raw_freedom=freedom, half_width=0)
    weight = np.zeros(batch.weights_of_rows.shape)
    weight[0, 0, 1 : lines + 1] = 1 / lines
    expected = variance_of_projection([batch], [weight.ravel()], noise_freedom([batch], [weight.ravel()]))
    g = np.random.default_rng(0)
    known = np.isinf(freedom)
    deviation = np.ones((40000, lines)) if known else np.sqrt(g.chisquare(freedom, (40000, lines)) / (freedom - 2))
    residual = g.standard_normal(deviation.shape) / deviation
    projected = np.sum(residual / deviation, axis=1) ** 2 / np.sum(deviation**-2, axis=1)
    assert np.mean(projected) == pytest.approx(expected, abs=0.02)
