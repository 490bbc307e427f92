"""Held inputs: exact responses against sampling by others and against integration, exact derivatives."""

import numpy as np
import pytest
from scipy.signal import cont2discrete

from identification.errors import MisuseError, RangeError
from identification.models.hold import hold_factor
from identification.models.rational import RationalStructure
from identification.signals import HeldInput

T = 0.1
OMEGA = np.linspace(0.0, np.pi / T, 40)
SECOND = np.array([0.4, 1.3, 0.7, 0.9])  # (x + …) over x² + 0.4 x + 1.3
ZEROS = {"zero": "zoh", "first": "foh"}


@pytest.mark.parametrize("hold", ["zero", "first"])
@pytest.mark.parametrize("n_b", [0, 1, 2])
def test_samples_answer_as_a_sampled_model_does(hold, n_b):
    scale = 3.0
    structure = RationalStructure(2, n_b, frequency_scale=scale)
    zeta = np.concatenate([[0.4, 1.3], [0.5, -0.8, 2.0][: n_b + 1]])
    powers = scale ** -np.arange(3.0)[::-1]
    num, den, _ = cont2discrete(
        (zeta[2:] * powers[2 - n_b :], np.concatenate([[1], zeta[:2]]) * powers), T, ZEROS[hold]
    )
    z = np.exp(1j * OMEGA * T)
    wanted = np.polyval(num.ravel(), z) / np.polyval(den, z)
    assert np.allclose(structure.plant_response(zeta, OMEGA, HeldInput(T, hold)), wanted, rtol=1e-9)


@pytest.mark.parametrize(("hold", "tau"), [("zero", 0.25), ("first", 0.25), ("zero", 0.2), ("first", 0.03)])
def test_a_delay_that_is_no_multiple_of_the_sample_time_is_exact(hold, tau):
    """The steady period of x″ + 0.4 x′ + 1.3 x = u, y = 0.7 x′ + 0.9 x, by Runge–Kutta steps within each hold."""
    u, finer, periods = np.random.default_rng(1).standard_normal(16), 20, 40
    h, state, outputs = T / finer, np.zeros(2), []
    rate = np.array([[0.0, 1.0], [-1.3, -0.4]])
    for n in range(16 * periods * finer):
        k, part = divmod(n, finer)
        rise = (u[(k + 1) % 16] - u[k % 16]) / finer if hold == "first" else 0.0
        drive = [np.array([0.0, u[k % 16] + rise * (part + share)]) for share in (0.0, 0.5, 1.0)]
        outputs.append(0.7 * state[1] + 0.9 * state[0])
        k1 = rate @ state + drive[0]
        k2 = rate @ (state + h / 2 * k1) + drive[1]
        k3 = rate @ (state + h / 2 * k2) + drive[1]
        k4 = rate @ (state + h * k3) + drive[2]
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    y = np.array(outputs)[np.arange(16 * (periods - 1), 16 * periods) * finer - round(tau / h)]
    omega = 2 * np.pi * np.fft.rfftfreq(16, T)
    structure = RationalStructure(2, 1, delay=True)
    response = structure.plant_response(np.append(SECOND, tau), omega, HeldInput(T, hold))
    assert np.allclose(np.fft.irfft(response * np.fft.rfft(u), 16), y, atol=1e-6)


@pytest.mark.parametrize("hold", ["zero", "first"])
@pytest.mark.parametrize("n_b", [0, 1, 2])
@pytest.mark.parametrize("delay", [False, True])
def test_derivatives_are_those_of_the_response(hold, n_b, delay):
    structure = RationalStructure(2, n_b, frequency_scale=2.0, delay=delay)
    zeta = np.array([0.4, 1.3, 0.7, 0.9, -0.3][: n_b + 3] + [0.234] * delay)
    held = HeldInput(T, hold)
    found = structure.plant_gradient(np.stack([zeta, 1.1 * zeta]), OMEGA, held)
    assert found.shape == (2, structure.n_plant, len(OMEGA))
    for i in range(len(zeta)):
        step = 1e-6 * np.eye(len(zeta))[i]
        ends = [structure.plant_response(zeta + sign * step, OMEGA, held) for sign in (1, -1)]
        assert np.allclose(found[0, i], (ends[0] - ends[1]) / 2e-6, rtol=1e-6, atol=1e-7)


def test_fast_sampling_leaves_the_response_of_the_plant():
    structure, omega = RationalStructure(2, 1), np.array([0.0, 0.5, 1.0, 2.0])
    fast = HeldInput(1e-4, "first")
    assert np.allclose(
        structure.plant_response(SECOND, omega, fast), structure.plant_response(SECOND, omega), rtol=1e-6
    )
    zero = HeldInput(1e-3)
    wanted = structure.plant_response(SECOND, omega) * hold_factor(omega, zero)
    assert np.allclose(structure.plant_response(SECOND, omega, zero), wanted, rtol=1e-6)


def test_an_integrator_and_a_gain_are_seen_exactly():
    """Straight lines make the trapezoidal rule of an integrator, steps the sum; a gain is not changed at all."""
    omega = OMEGA[1:]
    z = np.exp(1j * omega * T)
    integrator = RationalStructure(1, 0)
    summed = integrator.plant_response(np.array([0.0, 2.0]), omega, HeldInput(T))
    assert np.allclose(summed, 2 * T / (z - 1))
    trapezoids = integrator.plant_response(np.array([0.0, 2.0]), omega, HeldInput(T, "first"))
    assert np.allclose(trapezoids, T * (z + 1) / (z - 1))
    assert np.allclose(RationalStructure(0, 0).plant_response(np.array([3.0]), OMEGA, HeldInput(T)), 3.0)


def test_band_limited_inputs_and_discrete_models_are_left_as_they_are():
    sampled = RationalStructure(1, 0, 1, sample_time=T)
    zeta = np.array([-0.5, 1.0])
    assert np.array_equal(sampled.plant_response(zeta, OMEGA, HeldInput(T)), sampled.plant_response(zeta, OMEGA))
    structure = RationalStructure(2, 1)
    assert np.array_equal(structure.plant_gradient(SECOND, OMEGA, None), structure.plant_gradient(SECOND, OMEGA))


def test_a_held_input_into_a_derivative_is_refused():
    with pytest.raises(MisuseError, match="impulses"):
        RationalStructure(1, 2).plant_response(np.ones(4), OMEGA, HeldInput(T))
    with pytest.raises(RangeError):
        HeldInput(0.0)
