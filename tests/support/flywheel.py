"""A flywheel whose bearing brakes with the cube of its speed, integrated here by Runge–Kutta: nothing of the models."""

from typing import Any

import numpy as np

PERIOD, FINE, PERIODS, SAMPLE_TIME = 256, 8, 4, 0.1
INERTIA, DAMPING, SLOPE, CUBE = 0.5, 0.4, 0.3, 0.12
POINTS, LEVELS = (0.0, 0.5, 1.0), (0.6, 1.2)


def plant(**quantities: str) -> dict[str, Any]:
    """The description, with the quantities of input and output where they are given."""
    constant, affine = ({"factors": [{"kind": "polynomial", "degree": degree}]} for degree in (0, 1))
    signals = {
        "input": {"name": "M", "unit": "N m"},
        "output": {"name": "n", "unit": "rad/s"},
    }
    return {
        "name": "flywheel",
        "schedulingVariables": [{"name": "load", "minimum": 0.0, "maximum": 1.0}],
        **{
            name: {**one, **({"quantity": quantities[name]} if name in quantities else {})}
            for name, one in signals.items()
        },
        "structure": {"timeDomain": "continuous", "na": 1, "nb": 0},
        "basis": constant,
        "coefficientBases": [{"coefficient": "a1", "basis": affine}],
    }


def bodies(noise: float = 0.005) -> list[dict[str, Any]]:
    """Bodies of experiments with multisines: J ω' + (d₀ + d₁ p) ω + c ω³ = M, the second period and those after it."""
    generator = np.random.default_rng(3)
    found = []
    for point in POINTS:
        for level in LEVELS:
            lines = np.arange(1, 40)
            t = np.arange(2 * PERIOD * FINE) / (2 * FINE)
            phases = 2 * np.pi * (np.outer(lines, t) / PERIOD + generator.uniform(size=(len(lines), 1)))
            torque = level * np.sqrt(2 / len(lines)) * np.cos(phases).sum(axis=0)
            speed = _speed(torque, point)
            noisy = np.tile(speed, PERIODS) + noise * speed.std() * generator.standard_normal(PERIODS * PERIOD)
            arrays = {"input": np.tile(torque[:: 2 * FINE], PERIODS).tolist(), "output": noisy.tolist()}
            stated = {"sampleTimeSeconds": SAMPLE_TIME, "periodSamples": PERIOD, "operatingPoint": [point]}
            found.append({"kind": "timeRecord", **stated, **arrays})
    return found


def _speed(torque: np.ndarray, point: float) -> np.ndarray:
    """The third period of the speed (PERIOD,); `torque` on half steps of one period."""

    def slope(w: float, m: float) -> float:
        return float((m - (DAMPING + SLOPE * point) * w - CUBE * w**3) / INERTIA)

    w, h, recorded = 0.0, SAMPLE_TIME / FINE, []
    for n in range(3 * PERIOD * FINE):
        if n >= 2 * PERIOD * FINE and n % FINE == 0:
            recorded.append(w)
        now, middle, end = (torque[i % len(torque)] for i in range(2 * n, 2 * n + 3))
        k1 = slope(w, now)
        k2 = slope(w + h / 2 * k1, middle)
        k3 = slope(w + h / 2 * k2, middle)
        w += h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(w + h * k3, end))
    return np.array(recorded)
