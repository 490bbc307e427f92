"""Spectra, line classes and noise variances of records."""

import numpy as np
import pytest

from identification.comparison.batch import EVEN, EXCITED, ODD
from identification.comparison.between import strongest_line
from identification.comparison.gather import gather
from identification.comparison.lack_of_fit import lack_of_fit
from identification.errors import MisuseError
from identification.extension.rows import Rows
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.oscillators import LINES, PERIOD, SAMPLE_TIME, batches, clean_records


def test_lines_sort_themselves_by_the_input():
    (batch,) = batches()
    classes = batch.classes[0]
    assert np.flatnonzero(classes == EXCITED).tolist() == LINES.tolist()
    assert classes[4] == EVEN
    assert classes[15] == ODD
    assert batch.points.shape == (5, 1)


def test_spectra_are_amplitudes_and_signals_come_back():
    (batch,) = batches()
    assert np.allclose(batch.signal(batch.inputs), batch.signals)
    finer = batch.signal(batch.inputs, 4)
    assert np.allclose(finer[:, ::4], batch.signals)
    assert np.allclose(batch.spectrum(finer), batch.inputs)


def test_the_residual_of_white_noise_has_unit_variance_at_every_kind_of_line():
    """Zero, Nyquist and inner lines alike; a factor two at the real lines would be seen."""
    real, inner = [], []
    for seed in range(300):
        g = np.random.default_rng(seed)
        u = np.tile(np.sin(2 * np.pi * 3 * np.arange(32) / 32), 4)
        (batch,) = gather([TimeRecord(u, g.standard_normal(128), 0.5, (0.0,), 32)])
        rows = batch.whiten(batch.outputs).reshape(2, -1)
        real.append(rows[0, batch.real])
        inner.append(rows[:, ~batch.real])
        assert np.all(rows[1, batch.real] == 0)
    assert np.mean(np.square(real)) == pytest.approx(1.0, abs=0.2)
    assert np.mean(np.square(inner)) == pytest.approx(1.0, abs=0.06)


def test_the_test_of_lack_of_fit_has_its_size_with_few_periods():
    """With χ² in place of F two periods would give far more than five per cent."""
    small = []
    for seed in range(400):
        g = np.random.default_rng(seed)
        u = np.tile(np.sin(2 * np.pi * 3 * np.arange(64) / 64), 2)
        (batch,) = gather([TimeRecord(u, g.standard_normal(128), 0.5, (0.0,), 64)])
        energy = float(np.sum(batch.whiten(batch.outputs) ** 2))
        small.append(lack_of_fit("", energy, batch.row_count, Rows((batch,)).noise_freedom).p_value < 0.05)
    assert 0.02 < np.mean(small) < 0.085


def test_chi_square_and_f_agree_with_their_definitions():
    assert lack_of_fit("", 3.841458820694124, 1.0, np.inf).p_value == pytest.approx(0.05)
    assert lack_of_fit("", 3.841458820694124, 1.0, 10.0).p_value == pytest.approx(0.0564, abs=0.03)
    assert lack_of_fit("", 3.0, 0.0, np.inf).p_value == 1.0


def test_hum_between_the_harmonics_is_seen_and_noise_is_not():
    record = clean_records(sigma=0.01)[0]
    t = np.arange(len(record)) * SAMPLE_TIME
    hum = 0.004 * np.cos(2 * np.pi * 10.25 / (PERIOD * SAMPLE_TIME) * t)
    noisy = TimeRecord(record.input, record.output + hum, SAMPLE_TIME, (0.0,), PERIOD)
    quiet, loud = (strongest_line(gather([one])[0].between[0]) for one in (record, noisy))
    assert quiet.p_value > 0.01
    assert loud.p_value < 1e-4


def test_responses_without_variance_have_no_known_scale():
    data = FrequencyResponse(np.array([1.0, 2.0]), np.array([1.0, 0.5j]), (0.0,))
    (batch,) = gather([data])
    assert not batch.scaled
    assert np.allclose(batch.variances, [[1.0, 0.25]])


def test_measurements_on_different_grids_stay_apart():
    one = FrequencyResponse(np.array([1.0, 2.0]), np.array([1.0, 0.5j]), (0.0,), variance=np.ones(2))
    other = FrequencyResponse(np.array([1.0, 3.0]), np.array([1.0, 0.5j]), (0.0,), variance=np.ones(2))
    found = gather([one, other, one])
    assert [batch.members.tolist() for batch in found] == [[0, 2], [1]]


def test_bad_input_is_refused():
    with pytest.raises(MisuseError, match="nothing to compare"):
        gather([])
    few = FrequencyResponse(np.ones(1), np.ones(1), (0.0,), variance=np.ones(1), variance_degrees_of_freedom=2.0)
    with pytest.raises(MisuseError, match="degrees of freedom"):
        gather([few])
