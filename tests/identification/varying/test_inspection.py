"""What a record with varying scheduling shows, how a model reproduces it, and the spectrum of its noise."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT, coloured_deviation, disturbed, noise_free
from identification.errors import RangeError, ShapeError
from identification.varying.inspection import inspect_varying
from identification.varying.noise_spectrum import noise_between_harmonics, noise_of_errors
from identification.varying.records import VaryingRecord, steady_periods
from identification.varying.reproduction import reproduced
from tests.support import varying


def record(seed: int = 1, **options: object) -> VaryingRecord:
    return replace(VaryingRecord(*varying.turbine(seed), 1.0, None, PLANT.variables), **options)


def test_a_synchronised_record_is_understood() -> None:
    seen = inspect_varying(record())
    assert (seen.period, seen.period_detected, seen.own_periods) == (120, True, (120, 10))
    assert seen.steady is not None
    assert (seen.input_deviation, seen.not_synchronised) == (0.0, "")
    assert seen.noise_deviations == pytest.approx([varying.NOISE], rel=0.05)
    assert len(seen.excited_frequencies) == 59
    assert seen.excited_frequencies[0] == pytest.approx(2 * np.pi / 120)
    expected = 20 * np.log10(varying.turbine()[1].std() / varying.NOISE)
    assert seen.signal_to_noise_db == pytest.approx(expected, abs=0.3)
    assert any("every 120 samples" in warning for warning in seen.warnings)


def test_what_is_wrong_is_said() -> None:
    u, y, p = varying.turbine()
    t = np.arange(len(u))[:, None]
    slipped = inspect_varying(record(scheduling=np.cos(2 * np.pi * t / 10.1), period=120))
    assert slipped.steady is None
    assert slipped.input_deviation == 0
    assert slipped.scheduling_deviation == pytest.approx(np.sqrt(8) * abs(np.sin(np.pi * 120 / 10.1)), rel=0.01)
    still = inspect_varying(record(scheduling=0 * p, input=0 * u + 1))
    texts = " ".join(still.warnings)
    assert "does not vary" in texts
    assert "is constant" in texts
    clipped = inspect_varying(record(output=np.clip(y, -1, 1)))
    assert clipped.saturated_fraction > 0.05
    assert any("saturates" in warning for warning in clipped.warnings)
    with pytest.raises(RangeError, match="input 1 is zero"):
        inspect_varying(record(input=0 * u))


def test_a_record_that_begins_anywhere_is_reproduced() -> None:
    clean = noise_free("white", 1000)
    late = reproduced(PLANT.model(), clean.part(300, 900))
    assert late.variance_accounted_for == pytest.approx(100, abs=1e-9)
    assert np.allclose(late.output, clean.output[300:900], atol=1e-9)
    assert np.linalg.norm(late.initial_state) > 0.1
    with pytest.raises(ShapeError, match="the record"):
        reproduced(PLANT.model(), VaryingRecord(clean.input, clean.output, np.tile(clean.scheduling, 2), 1.0))
    with pytest.raises(RangeError, match="sampled every 2 s"):
        reproduced(PLANT.model(), replace(clean, sample_time=2.0))
    with pytest.raises(RangeError, match="unstable"):
        reproduced(replace(PLANT, a=2 * PLANT.a).model(), noise_free("white", 5000))


def test_both_noise_spectra_are_those_of_the_noise() -> None:
    clean = noise_free("multisine", 20_000)
    measured = disturbed(clean, 0.5, True, np.random.default_rng(1))
    between = noise_between_harmonics(steady_periods(measured, 1), 1.0)
    left = noise_of_errors(measured.output - clean.output, 1.0)
    for found in (between, left):
        z = np.exp(-1j * found.frequencies)
        expected = 0.25 * abs((1 + 0.5 * z) / (1 - 0.8 * z)) ** 2 / coloured_deviation() ** 2
        ratio = found.spectrum[:, 0] / expected
        assert ratio.mean() == pytest.approx(1, abs=0.05)
        assert ratio.std() < 3 * np.sqrt(2 / found.degrees_of_freedom)
        assert found.covariance[0, 0] == pytest.approx(0.25, rel=0.1)
