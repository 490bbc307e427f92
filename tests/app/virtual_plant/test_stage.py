"""The simulated plant does what its equations say."""

import numpy as np
import pytest

from app.virtual_plant.campaign import HELD_OUT, POSITIONS, SAMPLE_TIME, first_campaign
from app.virtual_plant.hidden import EFFECTS, Hidden
from app.virtual_plant.multisine import random_phases
from app.virtual_plant.stage import Stage
from identification.arrays import FloatArray
from identification.effects.library import library

LINES = np.arange(1, 33)


def response(hidden: Hidden, position: float = 0.3, level: float = 10.0) -> tuple[FloatArray, FloatArray]:
    """Frequencies (rad/s) and Y/U at the excited lines, without noise."""
    force = random_phases(np.array([level]), 128, 32, np.random.default_rng(1))
    y = Stage(hidden, noise=0.0).measure(np.array([position]), force, SAMPLE_TIME, 1, np.random.default_rng(0))
    u, y = np.fft.rfft(force[0]), np.fft.rfft(y[0])
    excited = np.flatnonzero(abs(u) > 1e-6 * abs(u).max())
    return 2 * np.pi * excited / (128 * SAMPLE_TIME), y[excited] / u[excited]


def exact(omega: FloatArray, position: float = 0.3) -> FloatArray:
    return 1000 / (1.5 * (1j * omega) ** 2 + 20 * 1j * omega + 9000 - 8000 * position)


def test_with_nothing_hidden_it_is_a_linear_oscillator() -> None:
    omega, found = response(Hidden())
    np.testing.assert_allclose(found, exact(omega), rtol=2e-4)


def test_a_late_force_turns_the_phase() -> None:
    omega, found = response(EFFECTS["delay"])
    np.testing.assert_allclose(found, np.exp(-8e-4j * omega) * exact(omega), rtol=2e-4)


def test_a_second_mode_is_added() -> None:
    omega, found = response(EFFECTS["resonance"])
    added = 20 / (110.0**2 - omega**2 + 2j * 0.03 * 110.0 * omega)
    np.testing.assert_allclose(found, exact(omega) + added, rtol=0.01)


@pytest.mark.parametrize("kind", EFFECTS)
def test_each_effect_is_in_the_library_and_changes_the_answer_a_little(kind: str) -> None:
    assert kind in {effect.kind for effect in library()}
    omega, found = response(EFFECTS[kind])
    change = np.linalg.norm(found - exact(omega)) / np.linalg.norm(exact(omega))
    assert 0.002 < change < 0.3


@pytest.mark.parametrize("kind", ["cubic_stiffness", "quadratic_damping", "dead_band_spring", "saturation"])
def test_effects_on_signals_vanish_with_the_level(kind: str) -> None:
    omega, found = response(EFFECTS[kind], level=0.05)
    np.testing.assert_allclose(found, exact(omega), rtol=2e-3)


def test_the_noise_is_white_and_as_large_as_stated() -> None:
    still = np.zeros((1, 2048))
    noise = Stage(noise=0.05).measure(np.array([0.1]), still, SAMPLE_TIME, 1, np.random.default_rng(3))[0]
    assert noise.std() == pytest.approx(0.05, rel=0.05)
    assert abs(np.corrcoef(noise[1:], noise[:-1])[0, 1]) < 0.08


def test_held_out_records_are_at_other_positions_and_the_same_seed_gives_the_same() -> None:
    campaigns = [first_campaign(Stage(), np.random.default_rng(4)) for _ in range(2)]
    assert {record.operating_point[0] for record in campaigns[0].fitted} == set(POSITIONS)
    assert {record.operating_point[0] for record in campaigns[0].held_out} == set(HELD_OUT)
    assert not set(POSITIONS) & set(HELD_OUT)
    for one, other in zip(campaigns[0].fitted, campaigns[1].fitted, strict=True):
        np.testing.assert_array_equal(one.output, other.output)
