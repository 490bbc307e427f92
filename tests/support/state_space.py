"""Random stable state-space systems."""

import numpy as np

from identification.models.system import StateSpace
from identification.signals import FrequencyResponse


def random_system(generator, order, inputs, outputs, sample_time, radius=(0.3, 0.95), scale=3.0):
    """A stable system with poles spread over the disc, or over the band up to `scale` rad/s in continuous time."""
    g, pairs = generator, order // 2
    modulus, angle = g.uniform(*radius, pairs), g.uniform(0.1, 3.0, pairs)
    poles = modulus * np.exp(1j * angle)
    if sample_time is None:
        poles = scale * g.uniform(0.1, 1.0, pairs) * (-g.uniform(0.02, 0.5, pairs) + 1j)
    a = np.zeros((order, order))
    for i, pole in enumerate(poles):
        a[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
    if order % 2:
        a[-1, -1] = g.uniform(*radius) * (1 if sample_time else -scale)
    turn = np.linalg.qr(g.standard_normal((order, order)))[0]
    b, c, d = (g.standard_normal(s) for s in ((order, inputs), (outputs, order), (outputs, inputs)))
    return StateSpace(turn @ a @ turn.T, turn @ b, c @ turn.T, d, sample_time)


def wide_system(generator, order, inputs, outputs, lowest, highest):
    """A stable continuous-time system with modes spread evenly over the logarithm of a band in rad/s."""
    g, pairs = generator, order // 2
    omega = np.geomspace(2 * lowest, highest / 2, pairs) if pairs > 1 else np.full(pairs, np.sqrt(lowest * highest))
    omega = omega * g.uniform(0.8, 1.25, pairs)
    poles = omega * (-g.uniform(0.02, 0.5, pairs) + 1j)
    a = np.zeros((order, order))
    scale = np.full(order, (lowest * highest) ** 0.25)
    for i, pole in enumerate(poles):
        a[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[pole.real, pole.imag], [-pole.imag, pole.real]]
        scale[2 * i : 2 * i + 2] = np.sqrt(omega[i])
    if order % 2:
        a[-1, -1] = -np.sqrt(lowest * highest)
    b, c, d = (g.standard_normal(s) for s in ((order, inputs), (outputs, order), (outputs, inputs)))
    return StateSpace(a, scale[:, None] * b, c * scale, d)


def relative_error(model, system, omega):
    """‖G_model − G‖/‖G‖ over the frequencies."""
    truth = system.frequency_response(omega)
    return np.linalg.norm(model.frequency_response(omega) - truth) / np.linalg.norm(truth)


def noisy(system, omega, deviation, generator):
    """The response of a system with circular noise of a standard deviation (F,), its variance stated."""
    truth = system.frequency_response(omega)
    sigma = np.broadcast_to(np.reshape(deviation, (-1, 1, 1)), truth.shape)
    noise = generator.standard_normal(truth.shape) + 1j * generator.standard_normal(truth.shape)
    return FrequencyResponse(omega, truth + sigma / np.sqrt(2) * noise, (0.0,), system.sample_time, sigma**2)


def exact(system, omega):
    """The noise-free response of a system."""
    return FrequencyResponse(omega, system.frequency_response(omega), (0.0,), system.sample_time)
