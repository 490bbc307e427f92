"""Hysteresis composed pairwise against following it sample by sample."""

import numpy as np

from identification.places.memory import dahl, play


def wave(seed):
    g = np.random.default_rng(seed)
    t = np.arange(257) / 257
    return np.stack(
        [sum(g.normal() * np.cos(2 * np.pi * k * t + g.uniform(0, 6)) for k in range(1, 6)) for _ in range(3)]
    )


def test_play_follows_its_definition():
    x, z = wave(1), np.zeros(3)
    for _ in range(3):
        out = []
        for now in x.T:
            z = np.minimum(np.maximum(z, now - 0.7), now + 0.7)
            out.append(z)
    assert np.allclose(play(x, 0.7), np.transpose(out))


def test_a_play_wider_than_the_signal_never_moves():
    assert np.ptp(play(wave(2), 1e3)) == 0


def test_dahl_follows_its_differential_equation():
    x, z = wave(3), np.zeros(3)
    for _ in range(6):
        out = []
        for step in np.diff(x, prepend=x[:, -1:]).T:
            for _ in range(50):
                z = z + (step - abs(step) * z) / 0.8 / 50
            out.append(z)
    assert np.allclose(dahl(x, 0.8), np.transpose(out), atol=5e-3)
    assert abs(dahl(x, 0.01)).max() <= 1 + 1e-9
