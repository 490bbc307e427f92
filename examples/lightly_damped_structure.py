"""A lightly damped structure of order 42, from a force to an acceleration, and its response on 512 lines at 200 Hz.

It stands in for the measured truss of [Akcay2008, Identification of a flexible truss structure], which is not public.
"""

import numpy as np
from scipy.linalg import block_diag

from identification.models.system import StateSpace
from identification.signals import FrequencyResponse
from identification.subspace.time_domains import held

SAMPLE_TIME = 1 / 200
MODES = 21
LINES = 512


def structure(seed: int = 7) -> StateSpace:
    """The structure behind a zero-order hold, order 42, one input and one output.

        G(s) = Σ_i r_i s² / (s² + 2 ζ_i ω_i s + ω_i²)

    with 21 modes from 4 to 92 Hz, damping ratios ζ_i between 0.4 and 1.5 %, and participations r_i of either sign.
    """
    g = np.random.default_rng(seed)
    frequencies = np.linspace(4.0, 92.0, MODES) + g.uniform(-1.2, 1.2, MODES)
    omega, zeta = 2 * np.pi * frequencies, g.uniform(0.004, 0.015, MODES)
    r = g.uniform(0.3, 1.0, MODES) * np.where(g.random(MODES) < 0.7, 1.0, -1.0)
    # States ω q and q̇ of each mode; the acceleration is r (u − 2 ζ ω q̇ − ω² q).
    a = block_diag(*([[0.0, w], [-w, -2 * z * w]] for w, z in zip(omega, zeta, strict=True)))
    b = np.tile([0.0, 1.0], MODES)[:, None]
    c = np.stack([-r * omega, -2 * r * zeta * omega], axis=1).reshape(1, -1)
    return held(StateSpace(a, b, c, [[r.sum()]]), SAMPLE_TIME)


def response(noise: float = 0.01, seed: int = 8) -> FrequencyResponse:
    """The response on 512 lines from zero to 100 Hz with circular noise, `noise` of its root mean square a line."""
    g = np.random.default_rng(seed)
    omega = np.pi / SAMPLE_TIME * np.arange(LINES) / (LINES - 1)
    truth = structure().frequency_response(omega)[:, 0, 0]
    deviation = noise * float(np.sqrt(np.mean(abs(truth) ** 2)))
    errors = deviation / np.sqrt(2) * (g.standard_normal(LINES) + 1j * g.standard_normal(LINES))
    return FrequencyResponse(omega, truth + errors, (0.0,), SAMPLE_TIME, np.full(LINES, deviation**2))
