"""Right effects first, those alike in one set, nothing invented, everything else called unknown."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.evidence import refit_short_list
from identification.diagnosis.missing import missing_response
from identification.diagnosis.staircase import conclusion, staircase
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.hysteresis import Hysteresis
from identification.effects.inductance import Inductance
from identification.effects.lag import Lag
from identification.effects.library import library
from identification.effects.misplaced_point import MisplacedPoint
from identification.effects.quadratic_sensor import QuadraticSensor
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.oscillators import (
    MODEL,
    OMEGA,
    PERIOD,
    POINTS,
    SAMPLE_TIME,
    batches,
    clean_records,
    integrated,
    linear,
    phasors,
    records,
)

SIGMA = 5e-3


def with_force(force, seed=1, gain=lambda u: u, stronger=1.0):
    g = np.random.default_rng(seed)
    inputs = [phasors(g, stronger * level) for level in (8.0, 5.0, 8.0, 5.0, 8.0)]
    return gather(records([(a, integrated(p, a, force, gain)) for p, a in zip(POINTS, inputs, strict=True)], g, SIGMA))


def kinds(found):
    return [one.score.candidate.effect.kind for one in found]


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        ("cubic_stiffness", lambda: with_force(lambda x, v: 15 * x**3)),
        ("quadratic_damping", lambda: with_force(lambda x, v: 0.2 * abs(v) * v)),
        ("quadratic_actuator", lambda: with_force(lambda x, v: 0, gain=lambda u: u + 0.01 * u**2)),
        ("delay", lambda: batches(2, SIGMA / 5, extra=lambda w: np.exp(-0.02j * w))),
        ("lag", lambda: batches(2, SIGMA / 5, extra=lambda w: 1 / (1 + 0.03j * w))),
    ],
)
def test_the_hidden_effect_is_first_and_explains_it(kind, data):
    found = diagnose(MODEL, data())
    assert kinds(found.announced)[0] == kind
    assert found.verdict == "explained"
    assert found.remaining.p_value > 1e-3
    assert found.confident == (found.best.weight > 0.95)
    assert found.lack_of_fit.p_value < 1e-6
    assert sum(one.weight for one in found.evidence) <= 1 + 1e-9


def test_nothing_is_announced_when_nothing_is_missing():
    found = [diagnose(MODEL, batches(seed), seed=seed) for seed in range(15)]
    assert sum(bool(one.announced) for one in found) <= 2
    quiet = next(one for one in found if not one.announced)
    assert quiet.verdict == "nothing missing"
    assert quiet.best is None


def test_coulomb_friction_without_its_kind_is_not_called_hysteresis():
    """Which it is when the travel may shrink to nothing; with the kind it is named."""
    data = with_force(lambda x, v: 0.6 * np.tanh(v / 0.002))
    assert kinds(diagnose(MODEL, data, (CoulombFriction(), Hysteresis())).announced) == ["coulomb_friction"]
    found = diagnose(MODEL, data, (Hysteresis(),))
    assert found.best.at_bound
    assert found.verdict == "partly explained"
    assert not found.confident
    assert staircase(MODEL, data, effects=(Hysteresis(),))[-1].model.effects == ()


def test_lack_of_fit_has_what_the_fitted_parameters_leave():
    data = batches(1)
    found = diagnose(MODEL, data, (Delay(),))
    assert found.lack_of_fit.degrees_of_freedom == sum(batch.row_count for batch in data) - 4


def test_an_effect_that_explains_no_more_than_its_parameter_costs_is_not_announced():
    """Adding noise-sized effects must not pay: BIC of the model as it is stays lowest."""
    data = batches(0)
    found = diagnose(MODEL, data, (QuadraticSensor(), Delay()))
    base = fit(MODEL, Rows(data))
    evidence = refit_short_list(base, found.scores).evidence
    assert all(one.bic > base.cost for one in evidence)
    assert all(one.explained < 6 for one in evidence)


def test_delay_and_lag_are_told_apart_only_by_the_edge_of_the_band():
    """At small amplitude both are in the announced set, and the confusability says why."""
    found = diagnose(MODEL, batches(3, 2e-2, extra=lambda w: np.exp(-0.01j * w)), (Delay(), Lag(), QuadraticSensor()))
    assert set(kinds(found.announced)) == {"delay", "lag"}
    names = [score.candidate.effect.kind for score in found.scores]
    pair = found.confusability[names.index("delay"), names.index("lag")]
    other = found.confusability[names.index("delay"), names.index("quadratic_sensor")]
    assert pair > 0.999
    assert other < 0.5
    assert not found.confident


def test_visibility_says_how_small_an_effect_would_be_seen():
    found = diagnose(MODEL, batches(4), (Delay(),))
    (visible,) = found.visibility
    hits = 0
    for seed in range(60):
        data = batches(seed, extra=lambda w: np.exp(-1j * w * visible.amplitude))
        hits += diagnose(MODEL, data, (Delay(),), seed=seed).scores[0].p_value < 0.025
    assert 0.78 <= hits / 60 <= 0.99


def test_what_needs_records_is_not_judged_from_responses():
    g = np.random.default_rng(5)
    omega = np.linspace(1, 12, 50)
    noise = 1e-4 * (g.standard_normal((5, 50)) + 1j * g.standard_normal((5, 50)))
    clean = MODEL.frequency_response([[p] for p in POINTS], omega)[..., 0, 0] + 3e-5j * omega
    data = [
        FrequencyResponse(omega, row, (p,), variance=np.full(50, 2e-8))
        for p, row in zip(POINTS, clean + noise, strict=True)
    ]
    found = diagnose(MODEL, gather(data), material=0.0)
    assert "inductance" in kinds(found.announced)
    assert diagnose(MODEL, gather(data)).verdict == "nothing missing"  # it is 0.4 % of the output
    reasons = {one.effect.kind: one.reason for one in found.visibility}
    assert "records" in reasons["cubic_stiffness"]
    assert reasons["delay"] == ""


def test_records_without_a_period_are_judged_through_their_response():
    g = np.random.default_rng(6)
    found = []
    for p in POINTS:
        amplitudes = np.concatenate([phasors(g)])
        u = np.tile(np.real(np.exp(1j * np.outer(np.arange(PERIOD) * SAMPLE_TIME, OMEGA)) @ amplitudes), 4)
        y = np.tile(linear(p, amplitudes), 4)
        found.append(TimeRecord(u, y + 1e-3 * g.standard_normal(len(y)), SAMPLE_TIME, (p,), PERIOD))
    assert diagnose(MODEL, gather(found)).verdict == "nothing missing"


def test_what_is_not_in_the_library_is_called_so():
    even = [
        TimeRecord(r.input, r.output + 0.2 * np.maximum(r.output, 0.1), SAMPLE_TIME, r.operating_point, PERIOD)
        for r in clean_records(7)
    ]
    linear = ("scheduled coefficient", "multiplies the linear response", "added to the linear response")
    effects = [one for one in library() if one.place in linear]
    found = diagnose(MODEL, gather(even), effects)
    assert found.verdict == "not in the library"
    assert not found.confident
    assert conclusion(staircase(MODEL, gather(even), effects=effects, largest=1)) == "not in the library"


def test_the_picture_of_what_is_missing_has_its_shape():
    data = batches(8, extra=lambda w: np.exp(-0.02j * w))
    found = diagnose(MODEL, data)
    (picture,) = missing_response(found.base)
    assert picture.response.shape == (5, 60)
    true = MODEL.frequency_response([[p] for p in POINTS], picture.frequencies)[..., 0, 0]
    after = found.best.fit.model
    wanted = (
        true * np.exp(-0.02j * picture.frequencies)
        - found.base.model.frequency_response([[p] for p in POINTS], picture.frequencies)[..., 0, 0]
    )
    overlap = abs(np.vdot(wanted, picture.response)) / np.linalg.norm(wanted) / np.linalg.norm(picture.response)
    assert overlap > 0.85
    assert len(after.effects) == 1


def test_two_effects_are_found_one_after_the_other():
    def spoilt(seed):
        made = clean_records(seed, extra=lambda w: np.exp(-0.02j * w))
        return gather(
            [TimeRecord(r.input, r.output + 0.1 * r.output**2, SAMPLE_TIME, r.operating_point, PERIOD) for r in made]
        )

    steps = staircase(MODEL, spoilt(9), spoilt(10))
    assert {one.effect.kind for one in steps[-1].model.effects} == {"delay", "quadratic_sensor"}
    errors = [step.held_out_error for step in steps]
    assert errors[-1] < 0.02 * errors[0]
    assert all(later < 1.01 * earlier for earlier, later in pairwise(errors))
    assert conclusion(steps) == "explained"
    assert steps[-1].diagnosis.lack_of_fit.p_value > 1e-3


def test_several_misplaced_points_do_not_stand_in_for_another_dependence():
    g = np.random.default_rng(12)
    inputs = [phasors(g) for _ in POINTS]
    bent = [(a, linear(p + 0.06 * (p * p - 0.5), a)) for p, a in zip(POINTS, inputs, strict=True)]
    data = gather(records(bent, g, 1e-3))
    steps = staircase(MODEL, data, effects=(MisplacedPoint(), Delay()), largest=3)
    assert [one.effect.kind for one in steps[-1].model.effects].count("misplaced_point") == 1
    assert conclusion(steps) == "not in the library"


def test_the_same_seed_gives_the_same_answer():
    data = batches(11, extra=lambda w: np.exp(-0.02j * w))
    one, other = (diagnose(MODEL, data, (Delay(), Lag(), Inductance()), seed=4) for _ in range(2))
    assert [s.adjusted_p for s in one.scores] == [s.adjusted_p for s in other.scores]
    assert one.evidence[0].bic == other.evidence[0].bic


def test_an_effect_that_leaves_more_than_noise_is_not_announced_with_confidence():
    """A cubic stiffness looks much like a stop beyond a gap: most is explained, and still it is not that."""
    data = with_force(lambda x, v: 40 * x**3)
    found = diagnose(
        MODEL,
        data,
        [one for one in library() if one.kind not in ("cubic_stiffness", "cubic_damping", "gravity", "law")],
    )
    assert found.best.weight > 0.95
    assert found.remaining.p_value < 1e-3
    assert not replace(found, verdict="explained").confident


@dataclass(frozen=True)
class Breaking(CubicStiffness):
    """A cubic stiffness up to a position of six, and a force beyond that no steady state can bear."""

    def force(self, x, velocity):
        return np.where(abs(x).max(axis=1, keepdims=True) > 6, 1e9 * x, x**3)


def test_the_staircase_stops_below_an_effect_without_steady_state_at_held_out_data():
    data, stronger = (with_force(lambda x, v: 15 * x**3, stronger=factor) for factor in (1, 20))
    (alone,) = staircase(MODEL, data, stronger, effects=(Breaking(),))
    assert alone.model.effects == ()
    assert alone.diagnosis.best is not None
    assert len(staircase(MODEL, data, data, effects=(Breaking(),))) == 2
