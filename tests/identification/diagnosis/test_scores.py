"""The score tests: uniform under the null, projected, one-sided, with the noise's own degrees of freedom."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, f, kstest

from identification.comparison.gather import gather
from identification.diagnosis.scores import _p_value, _tail, score_tests
from identification.diagnosis.signatures import SHAPED, TWICE, candidates, tangent_space
from identification.effects.antiresonance import Antiresonance
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.dead_band_spring import DeadBandSpring
from identification.effects.delay import Delay
from identification.effects.inductance import Inductance
from identification.effects.lag import Lag
from identification.effects.library import library
from identification.effects.quadratic_sensor import QuadraticSensor
from identification.effects.resonance import Resonance
from identification.effects.time_base import TimeBase
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.places.placed import placed
from identification.signals import FrequencyResponse
from tests.support.oscillators import MODEL, POINTS, batches

FEW = (Delay(), Lag(), CubicStiffness(), QuadraticSensor(), Resonance())


def base(seed=0, **options):
    return fit(MODEL, Rows(batches(seed, **options)))


def scored(found, effects=FEW):
    seen = [one for one in candidates(found, effects) if one.signatures]
    return {s.candidate.effect.kind: s for s in score_tests(found, seen, np.random.default_rng(1))}


@pytest.fixture(scope="module")
def null():
    return [scored(base(seed)) for seed in range(100)]


@pytest.mark.parametrize("kind", ["delay", "cubic_stiffness", "quadratic_sensor", "resonance"])
def test_p_values_are_uniform_when_nothing_is_missing(null, kind):
    """The resonance has thirty variants; without the projection p of the others would not be uniform either."""
    p = [scores[kind].p_value for scores in null]
    if kind == "delay":
        p = [value for value in p if value < 0.999]
    assert kstest(p, "uniform").pvalue > 1e-3


def test_the_family_has_one_error_rate(null):
    alarms = np.mean([min(s.adjusted_p for s in scores.values()) < 0.1 for scores in null])
    assert 0.03 < alarms < 0.18


def test_signatures_are_orthogonal_to_what_the_parameters_can_do():
    found = base()
    space = tangent_space(found)
    for candidate in candidates(found, FEW):
        for one in candidate.signatures:
            assert abs(one.basis @ space.T).max() < 1e-9
            assert np.allclose(one.basis @ one.basis.T, np.eye(len(one.basis)))
            assert 0 < one.kept <= 1


def test_a_change_that_the_parameters_can_make_is_invisible_not_absent():
    (candidate,) = candidates(base(), [TimeBase()])
    assert candidate.signatures == ()
    assert "invisible" in candidate.why_not


@pytest.mark.parametrize(("sign", "expected"), [(1, True), (-1, False)])
def test_a_delay_is_found_and_an_advance_is_none(sign, expected):
    found = scored(base(extra=lambda w: np.exp(-1j * w * sign * 2e-3)), (Delay(),))["delay"]
    assert (found.p_value < 1e-3) == expected
    assert np.sign(found.statistic) == sign


def test_the_amplitude_is_read_off_the_score():
    found = base(extra=lambda w: np.exp(-2e-3j * w))
    score = scored(found, (Delay(),))["delay"]
    assert score.signature.amplitudes(found.residual) == pytest.approx([2e-3], rel=0.15)


@pytest.mark.parametrize("raw", [np.inf, 6.0])
def test_the_p_of_one_two_sided_effect_is_that_of_its_statistic(raw):
    """χ² with one degree of freedom where the noise is known, hardly more than that where it is estimated."""
    (batch,) = batches(3)
    found = fit(MODEL, Rows((replace(batch, raw_freedom=raw, freedom=90 * raw / 6),)))
    score = scored(found, (QuadraticSensor(),))["quadratic_sensor"]
    assert score.p_value == pytest.approx(chi2.sf(score.statistic, 1), abs=0.04)


def test_the_whole_library_can_be_scored():
    scores = scored(base(), library())
    assert len(scores) > 30
    assert all(0 <= s.adjusted_p <= 1 and np.isfinite(s.statistic) for s in scores.values())


def test_the_best_variant_is_the_best_when_p_is_too_small_to_tell():
    """All p of a strong effect are zero; the variant is then the one that explains most."""
    found = base(sigma=1e-5, extra=lambda w: 1 - 0.3 * 0.6j * w * 5 / (25 - w**2 + 0.6j * w * 5))
    score = scored(found, (Antiresonance(),))["antiresonance"]
    sizes = [float(np.sum((one.basis @ found.residual) ** 2)) for one in score.candidate.signatures]
    assert score.p_value == 0
    assert sizes[score.best] == max(s for s, one in zip(sizes, score.candidate.signatures, strict=True) if s > 0)


def test_adjusted_p_values_are_never_below_the_ones_they_adjust():
    """Also where they are smaller than the draws resolve: for forty effects then by about forty times."""
    found = scored(base(3, extra=lambda w: np.exp(-6e-4j * w)), library())
    assert all(s.adjusted_p >= s.p_value or s.adjusted_p > 0.5 for s in found.values())
    tiny = [s for s in found.values() if 0 < s.p_value < 1e-5]
    assert tiny
    assert all(s.adjusted_p >= 20 * s.p_value for s in tiny)


def test_below_what_the_draws_resolve_the_bound_counts_all_that_was_tried():
    assert _tail(1e-4, np.linspace(3e-4, 1.0, 4000), 40) == pytest.approx(4e-3)
    assert _tail(0.05, np.linspace(1e-3, 1.0, 4000), 40) == pytest.approx(0.05, rel=0.03)


def test_the_p_of_a_signature_at_one_line_is_that_of_a_ratio_of_variances():
    """Whitening makes the mean of r² one, F(1, ν) has the mean ν/(ν − 2)."""
    found = base(3)
    score = scored(found, (QuadraticSensor(),))["quadratic_sensor"]
    alone = replace(score.signature, freedom=10.0, variance=1.0)
    assert _p_value(found, alone, 4.0) == pytest.approx(f.sf(4.0 * 10 / 8, 1, 10))


def test_variances_that_are_hardly_known_raise_no_false_alarms():
    """Each line brings its own variance with five degrees of freedom: S is then a third larger than χ² says."""
    g = np.random.default_rng(0)
    omega = np.linspace(1, 12, 40)
    clean = MODEL.frequency_response([[p] for p in POINTS], omega)[..., 0, 0]
    p = []
    for _ in range(250):
        noise = 1e-3 * np.sqrt(0.5) * (g.standard_normal(clean.shape) + 1j * g.standard_normal(clean.shape))
        variance = 1e-6 * g.chisquare(10, clean.shape) / 10
        data = [
            FrequencyResponse(omega, y, (at,), variance=v, variance_degrees_of_freedom=5.0)
            for at, y, v in zip(POINTS, clean + noise, variance, strict=True)
        ]
        found = fit(MODEL, Rows(gather(data)))
        p.append(scored(found, (Inductance(),))["inductance"].p_value)
    assert kstest(p, "uniform").pvalue > 1e-2
    assert np.mean(np.array(p) < 0.05) < 0.08


def test_a_curve_of_fitted_shape_is_not_joined_by_another_in_its_place():
    spring = placed(DeadBandSpring(gap=0.1), 0, 1, 1.0)
    found = fit(MODEL.plus(spring), Rows(batches(2)), iterations=1)
    seen = candidates(found, library())
    reasons = {one.effect.kind: one.why_not for one in seen}
    assert (reasons["dead_band_spring"], reasons["gravity"], reasons["hysteresis"]) == (TWICE, SHAPED, SHAPED)
    assert not any(reasons[kind] for kind in ("cubic_stiffness", "coulomb_friction", "saturation"))
    assert {one.effect.kind for one in seen if not one.judged} == {
        "dead_band_spring",
        "gravity",
        "hysteresis",
        "second_variable",
    }
