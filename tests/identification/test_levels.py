"""Records about an operating level: what is estimated is the movement about it, with covariances that hold."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal, stats

from identification.channels import Channel, Channels
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.lti.rational_fit import RationalFit
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord
from identification.spectral.periodic_average import PeriodicAverage
from tests.support.plants import polynomial_dependence

STRUCTURE = RationalStructure(n_a=1, n_b=0, n_k=1, sample_time=1.0)
TRUTH = np.array([-0.8, 0.4])
INPUT_LEVEL, OUTPUT_LEVEL = 10.0, 300.0
STATED = Channels(Channel(level=INPUT_LEVEL), Channel(level=OUTPUT_LEVEL))


def moved_by(point: float, seed: int, period: int | None = None, noise: float = 0.05) -> TimeRecord:
    """y − 300 = 0.4 q/(1 − (0.8 − 0.1 p) q) (u − 10), recorded after the plant has settled."""
    g = np.random.default_rng(seed)
    if period is None:
        u = np.cumsum(g.standard_normal(900)) * 0.1 + g.standard_normal(900)
    else:
        u = np.tile(g.standard_normal(period), 9)
    y = signal.lfilter([0.0, 0.4], [1.0, -0.8 + 0.1 * point], u)
    kept = slice(300 if period is None else period, None)
    y = y[kept] + noise * g.standard_normal(len(y[kept]))
    return TimeRecord(u[kept] + INPUT_LEVEL, y + OUTPUT_LEVEL, 1.0, (point,), period)


@pytest.mark.parametrize("stated", [True, False])
def test_the_covariance_holds_about_a_level(stated):
    distances = []
    for seed in range(60):
        record = moved_by(0.0, seed)
        model = PredictionError().estimate(STRUCTURE, replace(record, channels=STATED) if stated else record).model
        error = model.zeta - TRUTH
        distances.append(error @ np.linalg.solve(model.covariance, error))
    assert stats.kstest(distances, stats.chi2(2).cdf).pvalue > 1e-3


def test_the_joint_covariance_holds_about_a_level():
    dependence, theta = polynomial_dependence(1, 0), np.array([-0.8, 0.1, 0.4])
    distances = []
    for seed in range(25):
        records = [moved_by(p, 100 * seed + i) for i, p in enumerate((0.0, 0.5, 1.0))]
        model = JointLikelihood().estimate(STRUCTURE, dependence, records).model
        distances.append((model.theta - theta) @ np.linalg.solve(model.covariance, model.theta - theta))
    assert stats.kstest(distances, stats.chi2(3).cdf).pvalue > 1e-3


def test_averages_over_periods_leave_an_unknown_level_out_and_use_a_stated_one():
    record = moved_by(0.0, 1, period=64)
    omega = 2 * np.pi * np.arange(33) / 64
    truth = signal.freqz([0.0, 0.4], [1.0, -0.8], omega)[1]
    unknown = PeriodicAverage().estimate(record)
    known = PeriodicAverage().estimate(replace(record, channels=STATED))
    assert np.allclose(unknown.frequencies, omega[1:])
    assert np.allclose(known.frequencies, omega)
    for data, expected in ((unknown, truth[1:]), (known, truth)):
        assert np.all(abs(data.response - expected) < 6 * np.sqrt(data.variance))
    fitted = RationalFit().estimate(STRUCTURE, unknown).model
    assert abs(fitted.zeta - TRUTH) == pytest.approx(0, abs=6 * np.sqrt(np.diag(fitted.covariance)).max())


def test_a_large_level_hides_no_line():
    """The lines are judged against the largest movement, not against the level."""
    record = moved_by(0.0, 2, period=64)
    far = replace(record, input=record.input + 1e6, output=record.output + 1e6)
    assert len(PeriodicAverage().estimate(far)) == 32


def test_one_stated_level_is_taken_and_the_other_estimated():
    record = replace(moved_by(0.0, 3), channels=Channels(Channel(level=INPUT_LEVEL), Channel()))
    moved = record.about_its_level()
    assert not record.level_known
    assert moved.input == pytest.approx(record.input - INPUT_LEVEL)
    assert moved.output.mean() == pytest.approx(0, abs=1e-9)
    assert not np.any(replace(record, input=np.full(600, 0.1), channels=Channels()).about_its_level().input)


@pytest.mark.parametrize("lag", [1, 7])
def test_what_the_input_was_before_the_record_does_not_matter(lag):
    """Exact without noise from the middle of an experiment, whatever the delay."""
    u = np.random.default_rng(4).standard_normal(400) + 5
    numerator = np.concatenate([np.zeros(lag), [1.0, -0.4, 0.2]])
    y = signal.lfilter(numerator, [1.0, -0.5], u) - 3
    structure = RationalStructure(n_a=1, n_b=2, n_k=lag, sample_time=1.0)
    found = PredictionError().estimate(structure, TimeRecord(u[100:], y[100:], 1.0, (0.0,)))
    assert found.model.zeta == pytest.approx([-0.5, 1.0, -0.4, 0.2], abs=1e-9)
    assert found.model.structure == structure
    assert found.fit_percent > 99.9999
