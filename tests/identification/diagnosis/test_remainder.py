"""What a fit leaves: smooth remainders are found with their size; without variances the noise is what is rough."""

import numpy as np
import pytest
from scipy.stats import kstest

from benchmarks.campaigns.campaign import write
from benchmarks.campaigns.kinds import kinds
from benchmarks.cases.reading import read, stated
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose, misfit, rows_of
from identification.diagnosis.remainder import SmoothRemainder, rest
from identification.effects.cubic_dependence import CubicDependence
from identification.effects.delay import Delay
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.oscillators import MODEL, PERIOD, POINTS, SAMPLE_TIME, batches, clean_records

OMEGA = np.geomspace(1.0, 15.0, 60)


def responses(seed, noise=0.01, extra=None, points=POINTS, omega=OMEGA):
    """Without variances; noise in proportion to the response."""
    g = np.random.default_rng(seed)
    clean = np.array([1 / (30 + 10 * p - omega**2 + 1.5j * omega) for p in points])
    if extra is not None:
        clean = clean * extra(np.array(points)[:, None], omega)
    n = g.standard_normal((2, *clean.shape))
    made = clean * (1 + noise * (n[0] + 1j * n[1]) / np.sqrt(2))
    return gather([FrequencyResponse(omega, row, (p,)) for p, row in zip(points, made, strict=True)])


def smooth(p, omega):
    return 1 + 0.03 * np.sin(2 * np.log(omega) + p)


def fitted(data):
    return fit(MODEL, rows_of(MODEL, data))


def test_without_variances_the_noise_is_what_neither_model_nor_smooth_kernel_takes():
    for extra in (None, smooth):
        found = fitted(responses(1, 0.01, extra))
        remainder = SmoothRemainder(found).of(found)
        deviation = found.rows.scales[0] * np.sqrt(remainder.noise)
        assert deviation == pytest.approx(0.01, rel=0.1)
        assert (remainder.size > 0.01) == (extra is not None)


def test_the_test_without_variances_is_uniform_and_finds_what_is_smooth():
    p = [misfit("", fitted(responses(seed)), seed).p_value for seed in range(80)]
    assert np.mean(np.array(p) < 0.05) < 0.12
    assert np.mean(np.array(p) >= 1e-3) == 1
    assert misfit("", fitted(responses(3, 0.01, smooth))).p_value < 1e-6


def test_nothing_missing_is_not_said_of_a_large_smooth_error_without_variances():
    """An unknown shape of 17 % that no effect has: p = 1 came of judging by the fit under test."""
    data = responses(5, 0.002, lambda p, w: 1 + 0.25 * np.sin(4 * np.log(w)) * (1 + 0.5 * p))
    found = diagnose(MODEL, data, (Delay(),))
    assert found.verdict == "not in the library"
    assert found.lack_of_fit.p_value < 1e-6
    assert found.rest_before == pytest.approx(0.15, abs=0.08)
    quiet = diagnose(MODEL, responses(6, 0.002), (Delay(),))
    assert quiet.verdict == "nothing missing"
    assert "p =" in quiet.reason


def test_too_few_numbers_cannot_be_judged():
    data = responses(7, 0.01, points=(-1.0, 1.0), omega=np.array([2.0, 5.0, 8.0]))
    found = diagnose(MODEL, data, (Delay(),))
    assert found.verdict == "cannot be judged"
    assert "too few" in found.reason


def test_repeats_are_known_noise_when_they_are_stated_alone():
    data = batches(2)
    found = fit(MODEL, Rows(data))
    remainder = SmoothRemainder(found).of(found)
    assert remainder.noise == 1.0
    assert remainder.immaterial <= float(found.residual @ found.residual) + 1e-9


def test_the_rest_is_unbiased_by_noise():
    """Noise of 15 % and nothing missing: nothing is left; a gain of the sensor beyond the model shows its size."""
    assert rest(fit(MODEL, Rows(batches(3, 2e-2)))) < 0.06
    spoilt = [
        TimeRecord(r.input, r.output + 0.1 * r.output**2, SAMPLE_TIME, r.operating_point, PERIOD)
        for r in clean_records(4, sigma=1e-3)
    ]
    found = fit(MODEL, Rows(gather(spoilt)))
    left = sum(
        float(np.sum(abs(b.outputs - f.output) ** 2)) for b, f in zip(found.rows.batches, found.flows, strict=True)
    )
    size = sum(float(np.sum(abs(b.outputs[b.classes == 0]) ** 2)) for b in found.rows.batches)
    assert rest(found) == pytest.approx(np.sqrt(left / size), rel=0.02)


def test_unexcited_lines_have_a_variance_of_their_own():
    spoilt = [
        TimeRecord(r.input, r.output + 0.1 * r.output**2, SAMPLE_TIME, r.operating_point, PERIOD)
        for r in clean_records(8)
    ]
    found = fit(MODEL, Rows(gather(spoilt)))
    odd, even = SmoothRemainder(found).of(found).excess
    assert even > 3
    assert odd < 0.3


def test_two_points_do_not_bear_a_cubic():
    data = responses(9, 0.001, lambda p, w: 1 + 0.05 * p**3, points=(-1.0, 1.0))
    found = diagnose(MODEL, data, (CubicDependence(),))
    assert found.announced == ()
    assert "4 operating points" in found.visibility[0].reason


def test_the_null_is_that_of_the_draws():
    p = np.array([misfit("", fitted(responses(seed, 0.05)), seed).p_value for seed in range(100, 160)])
    below = p[p < 0.5]
    assert kstest(2 * below, "uniform").pvalue > 1e-3


def test_noise_found_from_what_a_wrong_model_leaves_does_not_make_that_immaterial(tmp_path):
    """A hardening spring of half the output under a random telegraph that does not repeat."""
    made = kinds()["free_cubic"]("spring", np.random.default_rng([11, *b"free_cubic"]))
    write(tmp_path, [made])
    case = read(stated(tmp_path)[0], tmp_path)
    rows = rows_of(case.model, gather(case.fitted))
    assert rest(fit(case.model, rows, iterations=40)) > 0.1
