"""Bands of gain and phase hold what they should."""

import numpy as np
import pytest

from identification.confidence import gain_and_phase

RESPONSE = np.array([3.0 + 1.0j, -2.0 + 0.5j, -0.1 - 4.0j])
ROOT = np.array([[[0.02, 0.0], [0.03, 0.05]], [[0.05, 0.0], [-0.04, 0.01]], [[0.01, 0.0], [0.0, 0.08]]])
COVARIANCE = ROOT @ np.swapaxes(ROOT, 1, 2)


def test_bands_hold_95_percent_of_gains_and_phases() -> None:
    noise = np.einsum("fij,nfj->nfi", ROOT, np.random.default_rng(0).normal(size=(20_000, 3, 2)))
    drawn = RESPONSE + noise[..., 0] + 1j * noise[..., 1]
    bands = gain_and_phase(RESPONSE, COVARIANCE)
    lower, upper = bands.gain_band()
    assert np.mean((lower < abs(drawn)) & (abs(drawn) < upper), axis=0) == pytest.approx([0.95] * 3, abs=0.01)
    turned = np.angle(drawn / RESPONSE)
    lower, upper = (band - bands.phase for band in bands.phase_band())
    assert np.mean((lower < turned) & (turned < upper), axis=0) == pytest.approx([0.95] * 3, abs=0.01)


def test_gain_and_phase_are_those_of_the_response() -> None:
    bands = gain_and_phase(RESPONSE, COVARIANCE)
    np.testing.assert_allclose(bands.gain * np.exp(1j * bands.phase), RESPONSE)


def test_turning_the_response_turns_nothing_but_the_phase() -> None:
    turn = np.exp(0.7j)
    matrix = np.array([[turn.real, -turn.imag], [turn.imag, turn.real]])
    bands, turned = (
        gain_and_phase(RESPONSE, COVARIANCE),
        gain_and_phase(turn * RESPONSE, matrix @ COVARIANCE @ matrix.T),
    )
    np.testing.assert_allclose(turned.gain_deviation, bands.gain_deviation)
    np.testing.assert_allclose(turned.phase_deviation, bands.phase_deviation)
    np.testing.assert_allclose(np.exp(1j * (turned.phase - bands.phase)), turn)


def test_phase_is_unwrapped_and_unknown_at_zero() -> None:
    response = np.exp(-1j * np.linspace(0.0, 20.0, 50))
    assert gain_and_phase(response, np.zeros((50, 2, 2))).phase[-1] == pytest.approx(-20.0)
    at_zero = gain_and_phase(np.zeros(1, dtype=complex), np.eye(2)[None])
    assert at_zero.phase_band()[1][0] == pytest.approx(np.pi)
    assert at_zero.gain_band()[0][0] == 0.0
