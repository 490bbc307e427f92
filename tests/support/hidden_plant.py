"""A mass on a spring that stiffens with p and with its way, integrated here by Runge–Kutta: nothing of the models."""

from dataclasses import dataclass
from typing import Any

import numpy as np

PERIOD, STEPS, PERIODS, SAMPLE_TIME = 512, 4, 4, 0.05
DAMPING, STIFFNESS, SLOPE = 1.8, 64.0, 28.0

PLANT: dict[str, Any] = {
    "name": "sprung mass",
    "schedulingVariables": [{"name": "preload", "unit": "1", "minimum": -1.0, "maximum": 1.0}],
    "input": {"name": "force", "unit": "N"},
    "output": {"name": "way", "unit": "m"},
    "structure": {"timeDomain": "continuous", "na": 2, "nb": 0},
    "basis": {"factors": [{"kind": "polynomial", "degree": 0}]},
    "coefficientBases": [{"coefficient": "a2", "basis": {"factors": [{"kind": "polynomial", "degree": 1}]}}],
}


@dataclass(frozen=True)
class HiddenPlant:
    """x″ + c x′ + (k₀ + k₁ p) x + κ x³ = u; κ = `cubic` is what the model does not know."""

    cubic: float

    def records(self, points: list[float], level: float, seed: int, noise: float = 0.01) -> list[dict[str, Any]]:
        """Bodies of experiments: random-phase multisines, the output with white noise of that share of its size."""
        generator = np.random.default_rng(seed)
        lines = np.sort(generator.choice(np.arange(1, 101), 75, replace=False))
        phases = generator.uniform(0, 2 * np.pi, (len(points), len(lines)))
        phasors = level * np.sqrt(2 / len(lines)) * np.exp(1j * phases)
        inputs = _played(phasors, lines)
        outputs = self._steady(inputs, np.array(points))
        return [
            _body(p, u[:: 2 * STEPS], y + noise * y.std() * generator.standard_normal((PERIODS, PERIOD)))
            for p, u, y in zip(points, inputs, outputs, strict=True)
        ]

    def _steady(self, inputs: np.ndarray, points: np.ndarray) -> np.ndarray:
        """The second period of the answer, (M, PERIOD)."""
        state, h, recorded = np.zeros((2, len(points))), SAMPLE_TIME / STEPS, []
        stiffness = STIFFNESS + SLOPE * points

        def slope(s: np.ndarray, i: int) -> np.ndarray:
            x, v = s
            return np.stack([v, inputs[:, i] - DAMPING * v - stiffness * x - self.cubic * x**3])

        for n in range(2 * PERIOD * STEPS):
            if n >= PERIOD * STEPS and n % STEPS == 0:
                recorded.append(state[0])
            now, middle, end = (np.arange(2 * n, 2 * n + 3) % inputs.shape[1]).tolist()
            k1 = slope(state, now)
            k2 = slope(state + h / 2 * k1, middle)
            k3 = slope(state + h / 2 * k2, middle)
            k4 = slope(state + h * k3, end)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return np.stack(recorded, axis=1)


def _played(phasors: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """One period on the grid of half steps, (M, 2 · STEPS · PERIOD)."""
    grid = 2 * STEPS * PERIOD
    time = np.arange(grid) / grid
    return np.real(phasors @ np.exp(2j * np.pi * np.outer(lines, time)))


def _body(point: float, u: np.ndarray, y: np.ndarray) -> dict[str, Any]:
    return {
        "kind": "timeRecord",
        "operatingPoint": [point],
        "sampleTimeSeconds": SAMPLE_TIME,
        "periodSamples": PERIOD,
        "input": np.tile(u, PERIODS).tolist(),
        "output": y.ravel().tolist(),
    }
