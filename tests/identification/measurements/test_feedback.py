"""Feedback is seen where there is some and not where there is none, whatever the input, the plant and the noise."""

import numpy as np
import pytest

from identification.measurements.feedback import feedback_seen, feedback_test, repeats_exactly
from identification.measurements.inspection import inspect
from identification.signals import TimeRecord
from tests.support.loops import RESONANT, SLOW, WHITE, in_loop, integral, late, proportional
from tests.support.motions import INPUTS, STEP, integrated, nothing, played, records


@pytest.mark.parametrize("noise", [SLOW, RESONANT])
@pytest.mark.parametrize("controller", [proportional(1.0), late(0.5, 2), integral(0.4, 0.02)])
def test_controllers_are_seen(noise, controller):
    for seed in range(4):
        assert feedback_test(in_loop(seed, noise, controller, 4000)).p_value < 1e-4
        assert feedback_test(in_loop(seed, noise, controller, 2000), delayed=True).p_value < 1e-9


def test_white_noise_through_a_controller_without_memory_is_seen_where_the_plant_has_a_delay():
    """Without that knowledge u(t) = r(t) − y(t) cannot be told from a plant that answers within the sample."""
    for seed in range(4):
        record = in_loop(seed, WHITE, proportional(1.0), 2000)
        assert feedback_test(record, delayed=True).p_value < 1e-6
        assert feedback_test(record).p_value > 1e-3


@pytest.mark.parametrize("noise", [SLOW, RESONANT, WHITE])
def test_the_size_of_the_test_in_open_loop(noise):
    p = np.array([feedback_test(in_loop(seed, noise, samples=1000), delayed=True).p_value for seed in range(60)])
    assert np.mean(p < 0.05) <= 0.17
    assert np.min(p) > 1e-4
    assert 0.3 < np.mean(p) < 0.7


@pytest.mark.parametrize("kind", sorted(INPUTS))
@pytest.mark.parametrize("force", [nothing, lambda x, v: 0.1 * x**3], ids=["linear", "cubic"])
def test_no_input_and_no_distortion_is_taken_for_a_controller(kind, force):
    g = np.random.default_rng(5)
    signals = INPUTS[kind](g, 1500)
    assert not any(feedback_seen(one) for one in records(*integrated(played(signals), 1500, force), 0.01, g))


def test_an_input_that_is_not_held_is_not_taken_for_one():
    """Between band-limited samples a plant seems to answer before its input."""
    g = np.random.default_rng(2)
    length = 2**13
    omega = 2 * np.pi * np.fft.rfftfreq(length, 0.05)
    lines = np.fft.rfft(g.standard_normal(length))
    signals = [np.fft.irfft(x, length)[300:2300] for x in (lines, lines * 36 / (36 - omega**2 + 2.4j * omega))]
    u, y = signals[0], signals[1] + 1e-3 * g.standard_normal(2000)
    assert feedback_seen(TimeRecord(u, y, 0.05, (0.0,))) is None


def periodic(seed, gain, level=0.1, measured=0.0):
    g = np.random.default_rng(seed)
    r = np.tile(np.random.default_rng(99).standard_normal((3, 256)), 6)
    shown = []

    def control(t, x):
        y = x + level * g.standard_normal(3)
        shown.append(y)
        return r[:, t] - gain * (y + (shown[-2] if t else 0.0))

    u, _ = integrated(control, r.shape[1])
    u += measured * g.standard_normal(u.shape)
    return [
        TimeRecord(a[512:], b[512:], STEP, (0.0,), 256, hold="zero") for a, b in zip(u, np.array(shown).T, strict=True)
    ]


def test_periods_are_compared_with_each_other():
    assert all(feedback_seen(one) for one in periodic(1, 0.2))
    assert not any(feedback_seen(one) for one in periodic(2, 0.0, measured=0.2))
    assert all(repeats_exactly(one) and feedback_test(one) is None for one in periodic(3, 0.0))


def test_an_inspection_says_so():
    (warning,) = (
        text for text in inspect(in_loop(1, RESONANT, proportional(1.0), 2000)).warnings if "controller" in text
    )
    assert "State feedback" in warning
    stated = in_loop(1, RESONANT, proportional(1.0), 2000, feedback=True)
    assert not any("controller" in text for text in inspect(stated).warnings)
    assert not any("controller" in text for text in inspect(in_loop(1, SLOW, samples=2000)).warnings)


def test_a_commanded_input_is_told_from_one_in_a_loop():
    one = periodic(3, 0.0)[0]
    stated = TimeRecord(one.input, one.output, STEP, (0.0,), 256, feedback=True)
    assert any("same in every period" in text for text in inspect(stated).warnings)


def test_too_short_a_record_says_nothing():
    assert feedback_test(in_loop(1, SLOW, proportional(1.0), 60)) is None
