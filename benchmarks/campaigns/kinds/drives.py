"""Motors whose speed is measured and whose inertia grows with the load."""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.campaigns import laws
from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import band_limited, integrate
from benchmarks.campaigns.stage import FITTED, HELD_OUT, PERIOD, PERIODS, SETTLING, Law, no_law
from identification.arrays import FloatArray

SHARES = np.array([*np.repeat(FITTED, 2), *HELD_OUT])
SAMPLES = PERIOD * PERIODS


def _said(damping: float, inertia: Callable[[FloatArray], FloatArray], degree: int, scale: float) -> dict[str, Any]:
    """A model of first order whose coefficients d/J and 1/J are polynomials in the load."""
    shares = np.linspace(0, 1, 101)
    inverse = np.polynomial.polynomial.polyfit(shares, 1 / inertia(shares), degree) / scale
    return {
        "input": {"quantity": "voltage", "unit": "V"},
        "output": {"quantity": "speed", "unit": "rad/s"},
        "structure": {"n_a": 1, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "load", "unit": "kg m2", "minimum": 0.0, "maximum": 1.0},
        "polynomial_degrees": [degree, degree],
        "theta_start": [*(damping * inverse), *inverse],
    }


def _drive(
    case: str,
    g: np.random.Generator,
    degree: int,
    truth: Callable[[float, float], Truth],
    law: Callable[[float, float], Law],
    growth: float,
) -> Campaign:
    """Multisines at a motor J(p) ω′ + d ω + f(ω) = u; laws are sized by rms speed and damping."""
    empty, damping = 10 ** g.uniform(-1, 1), 1.0
    damping = empty * 10 ** g.uniform(0.3, 0.9)
    corner = damping / empty
    inertia = lambda p: empty * (1 + growth * p)  # noqa: E731
    step = 0.25 / corner
    lines = np.arange(1, PERIOD // 6, int(g.integers(1, 3)))
    amplitudes = np.sqrt(2 / len(lines)) * np.exp(2j * np.pi * g.random((len(lines), len(SHARES))))
    u = band_limited(amplitudes, lines, PERIOD)
    drive = np.tile(u, (SETTLING + 1, 1, 1))

    def speeds(hidden: Law) -> FloatArray:
        def slope(x: FloatArray, force: FloatArray, t: float) -> FloatArray:
            return np.asarray((force - damping * x - hidden(0 * x, x)) / inertia(SHARES))

        return integrate(slope, np.zeros((1, len(SHARES))), drive, step)[-PERIOD:, 0]

    rms = float(speeds(no_law).std())
    y = speeds(law(rms, damping))
    noise = 10 ** g.uniform(-2.7, -1.9)
    made = campaign(case, truth(rms, damping), _said(damping, inertia, degree, float(f"{corner:.1g}")))
    for e, p in enumerate(SHARES):
        tiled, fitted = np.tile(y[:, e], PERIODS), e < 8
        seen = tiled + fitted * noise * rms * g.standard_normal(SAMPLES)
        made.record(p, u[:, 0, e], seen, step, PERIOD, "fitted" if fitted else "held_out")
    return made


def motor_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction at a speed."""
    force = g.uniform(0.05, 0.3)
    truth = Truth(("coulomb_friction",), amplitude=force)
    return _drive(case, g, 3, lambda v, d: truth, lambda v, d: laws.coulomb(force, v), g.uniform(0.2, 0.5))


def motor_drag(case: str, g: np.random.Generator) -> Campaign:
    """Drag of a share of the linear damping at the rms speed."""
    share = g.uniform(0.1, 0.5)
    truth = lambda v, d: Truth(("quadratic_damping",), amplitude=share * d / v)  # noqa: E731
    return _drive(case, g, 3, truth, lambda v, d: laws.drag(share * d / v), g.uniform(0.2, 0.5))


def inertia_degree_1(case: str, g: np.random.Generator) -> Campaign:
    """All coefficients go as 1/J(p), the model is linear in p."""
    truth = Truth(("low_basis",))
    return _drive(case, g, 1, lambda v, d: truth, lambda v, d: no_law, g.uniform(0.6, 1.5))


def inertia_degree_2(case: str, g: np.random.Generator) -> Campaign:
    """All coefficients go as 1/J(p), the model has degree 2."""
    truth = Truth(("low_basis",), nothing_is_right=True)
    return _drive(case, g, 2, lambda v, d: truth, lambda v, d: no_law, g.uniform(0.3, 0.7))


def two_mass(case: str, g: np.random.Generator) -> Campaign:
    """A second inertia behind a spring, growing with p; the speed of the first is measured."""
    first, damping = g.uniform(0.5, 3), 1.0
    damping = first * g.uniform(0.5, 2)
    second = first * (g.uniform(0.3, 0.6) + g.uniform(0.4, 1.0) * SHARES)
    resonance = g.uniform(40, 120)
    spring = second.max() * resonance**2
    inner = 2 * g.uniform(0.02, 0.08) * second.max() * resonance
    step = 0.25 / resonance
    lines = np.arange(1, int(2.5 * resonance * PERIOD * step / (2 * np.pi)))
    amplitudes = np.sqrt(2 / len(lines)) * np.exp(2j * np.pi * g.random((len(lines), len(SHARES))))
    omega = 2 * np.pi * lines / (PERIOD * step)
    s = 1j * omega
    scale = 10.0
    total = lambda p: first + second[0] + (second[7] - second[0]) * p  # noqa: E731
    said = _said(damping, total, 1, scale) | {"input": {"quantity": "torque", "unit": "N m"}}
    made = campaign(case, Truth(("two_mass", "resonance")), said)
    noise = 10 ** g.uniform(-2.7, -1.9)
    waves = np.exp(2j * np.pi * np.outer(np.arange(PERIOD), lines) / PERIOD)
    for e, p in enumerate(SHARES):
        coupling = inner + spring / s
        behind = coupling * second[e] * s / (second[e] * s + coupling)
        y = np.tile(np.real(waves @ (amplitudes[:, e] / (first * s + damping + behind))), PERIODS)
        fitted = e < 8
        seen = y + fitted * noise * y.std() * g.standard_normal(SAMPLES)
        made.record(p, np.real(waves @ amplitudes[:, e]), seen, step, PERIOD, "fitted" if fitted else "held_out")
    return made
