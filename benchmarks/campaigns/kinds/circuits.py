"""A resonant circuit with a saturating coil, and a room whose surroundings swing with the day."""

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import band_limited, integrate
from benchmarks.campaigns.stage import FITTED, HELD_OUT, PERIODS, SETTLING
from identification.arrays import FloatArray

SHARES = np.array([*np.repeat(FITTED, 2), *HELD_OUT])


def _recorded(
    made: Campaign,
    g: np.random.Generator,
    points: FloatArray,
    drive: FloatArray,
    y: FloatArray,
    step: float,
    noise: float,
) -> Campaign:
    period = len(drive)
    for e, p in enumerate(points):
        fitted = e < 8
        seen = y[:, e] + fitted * noise * y[:, e].std() * g.standard_normal(len(y))
        made.record(p, drive[:, 0, e], seen, step, period, "fitted" if fitted else "held_out")
    return made


def _multisine(period: int, top: int, size: float, g: np.random.Generator) -> FloatArray:
    lines = np.arange(1, top)
    phases = np.exp(2j * np.pi * g.random((len(lines), len(SHARES))))
    return band_limited(size * np.sqrt(2 / len(lines)) * phases, lines, period)


def saturating_coil(case: str, g: np.random.Generator) -> Campaign:
    """L(i) i′ + R(T) i + v = u, C v′ = i with L = L₀/(1 + (i/i₀)²)."""
    capacity, resonance = 10 ** g.uniform(-7, -5), 10 ** g.uniform(3.5, 5)
    coil = 1 / (capacity * resonance**2)
    resistance, hotter = g.uniform(0.15, 0.4) * coil * resonance, g.uniform(0.2, 0.5)
    scale, period, step = float(f"{resonance:.1g}"), 512, 0.4 / resonance
    resistances = resistance * (1 + hotter * SHARES)
    drive = _multisine(period, int(2 * period * 0.4 / (2 * np.pi)), 1.0, g)

    def run(knee: float) -> FloatArray:
        def slope(x: FloatArray, u: FloatArray, t: float) -> FloatArray:
            rise = (u - resistances * x[0] - x[1]) * (1 + (x[0] / knee) ** 2) / coil
            return np.stack([rise, x[0] / capacity])

        return integrate(slope, np.zeros((2, len(SHARES))), np.tile(drive, (SETTLING + 1, 1, 1)), step)[-period:]

    knee = run(np.inf)[:, 0].std() * g.uniform(1.5, 4)
    v = np.tile(run(knee)[:, 1], (PERIODS, 1))
    said: dict[str, Any] = {
        "input": {"quantity": "voltage", "unit": "V"},
        "output": {"quantity": "voltage", "unit": "V"},
        "structure": {"n_a": 2, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "temperature", "unit": "degC", "minimum": 0.0, "maximum": 100.0},
        "polynomial_degrees": [1, 0, 0],
        "theta_start": [
            resistance / coil / scale,
            resistance * hotter / 100 / coil / scale,
            (resonance / scale) ** 2,
            (resonance / scale) ** 2,
        ],
    }
    made = campaign(case, Truth(("saturating_inductor", "law")), said)
    return _recorded(made, g, 100 * SHARES, drive, v, step, 10 ** g.uniform(-2.7, -1.9))


def day_swing(case: str, g: np.random.Generator) -> Campaign:
    """C T′ + h(p) (T − A sin(2πt/day + φ)) = P; the plant lacks nothing."""
    heat, loss, more = 10 ** g.uniform(4, 5.5), 10 ** g.uniform(0.8, 1.5), g.uniform(0.5, 1.5)
    period, step = 256, g.choice([30.0, 60.0, 120.0])
    losses = loss * (1 + more * SHARES)
    drive = _multisine(period, period // 8, 50.0, g)
    phases = g.uniform(0, 2 * np.pi, len(SHARES))

    def slope(swing: float) -> Callable[[FloatArray, FloatArray, float], FloatArray]:
        surroundings = lambda t: swing * np.sin(2 * np.pi * t / 86400 + phases)  # noqa: E731
        return lambda x, u, t: (u - losses * (x - surroundings(t))) / heat

    settled = int(np.ceil(8 * heat / loss / (period * step))) + SETTLING
    everything = np.tile(drive, (settled + PERIODS, 1, 1))
    runs = [
        integrate(slope(a), np.zeros((1, len(SHARES))), everything, step)[-PERIODS * period :, 0] for a in (0.0, 1.0)
    ]
    size = runs[0].std() * g.uniform(0.1, 0.5)
    y = runs[0] + size * (runs[1] - runs[0]) * (np.arange(len(SHARES)) < 8)
    scale = float(f"{loss / heat:.1g}")
    said = {
        "input": {"quantity": "heat flow", "unit": "W"},
        "output": {"quantity": "temperature", "unit": "K"},
        "structure": {"n_a": 1, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "flow", "unit": "kg/s", "minimum": 0.0, "maximum": 1.0},
        "polynomial_degrees": [1, 0],
        "theta_start": [loss / heat / scale, more * loss / heat / scale, 1 / heat / scale],
    }
    made = campaign(case, Truth(("hum", "drift"), nothing_is_right=True), said)
    return _recorded(made, g, SHARES, drive, y, step, 10 ** g.uniform(-2.7, -1.9))
