"""Random stable state-space systems."""

import numpy as np

from identification.state_space import StateSpace


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
