"""Folders of campaigns as others would hand them over, integrated here; nothing of the models is used."""

import json
from pathlib import Path
from typing import Any

import numpy as np

PERIOD, PERIODS, SAMPLE_TIME, STEPS = 256, 4, 0.02, 8


def write(folder: Path, cases: list[tuple[dict[str, Any], dict[str, np.ndarray]]]) -> Path:
    """index.json and one npz for each case."""
    (folder / "index.json").write_text(json.dumps([entry for entry, _ in cases]))
    for entry, arrays in cases:
        np.savez(folder / f"{entry['case']}.npz", **arrays)
    return folder


def driven(u: np.ndarray, points: np.ndarray, friction: float) -> np.ndarray:
    """Speeds (M, N) from rest of (0.5 + p) v′ + v + friction · tanh(v/0.001) = u, u (M, N, 2 · STEPS) on half steps."""
    v, recorded, h = np.zeros(len(points)), [], SAMPLE_TIME / STEPS

    def slope(v: np.ndarray, drive: np.ndarray) -> np.ndarray:
        return np.asarray((drive - v - friction * np.tanh(v / 1e-3)) / (0.5 + points))

    for n in range(u.shape[1]):
        recorded.append(v)
        half = u[:, n : n + 2].reshape(len(u), -1)
        for i in range(0, 2 * STEPS, 2):
            k1 = slope(v, half[:, i])
            k2 = slope(v + h / 2 * k1, half[:, i + 1])
            k3 = slope(v + h / 2 * k2, half[:, i + 1])
            k4 = slope(v + h * k3, half[:, (i + 2) % half.shape[1]])
            v = v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return np.stack(recorded, axis=1)


def multisines(count: int, generator: np.random.Generator, lines: int = 60) -> np.ndarray:
    """Odd random-phase multisines on the grid of half steps over one period, (count, PERIOD, 2 · STEPS)."""
    grid = 2 * STEPS * PERIOD
    k = np.arange(1, lines, 2)
    phases = generator.uniform(0, 2 * np.pi, (count, len(k)))
    waves = np.real(np.exp(1j * phases) @ np.exp(2j * np.pi * np.outer(k, np.arange(grid)) / grid))
    return np.asarray(4 * waves / np.sqrt(len(k) / 2)).reshape(count, PERIOD, 2 * STEPS)


def drive_case(name: str, friction: float, seed: int) -> tuple[dict[str, Any], dict[str, np.ndarray], np.ndarray]:
    """A drive with dry friction: its index entry, its arrays, and the outputs of the held-out experiments."""
    generator = np.random.default_rng(seed)
    points = np.array([0.0, 0.0, 0.5, 1.0, 1.0, 0.25, 0.75])
    u = multisines(len(points), generator)
    steady = driven(np.tile(u, (1, 3, 1)), points, friction)[:, 2 * PERIOD :]
    y = np.tile(steady, (1, PERIODS))
    y += 0.005 * y.std() * generator.standard_normal(y.shape)
    entry: dict[str, Any] = {
        "case": name,
        "input": {"quantity": "torque", "unit": "N m"},
        "output": {"quantity": "speed", "unit": "rad/s"},
        "input_between_samples": "band_limited",
        "closed_loop": False,
        "structure": {"n_a": 1, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": 1.0},
        "scheduling": {"name": "load", "unit": "kg m2", "minimum": 0.0, "maximum": 1.0},
        "polynomial_degrees": [2, 2],
        "theta_start": [2.0, -2.0, 0.7, 2.0, -2.0, 0.7],
        "experiments": [],
    }
    arrays = {}
    for m, p in enumerate(points):
        part, number = ("fitted", m) if m < 5 else ("held_out", m - 5)
        entry["experiments"].append(
            {
                "part": part,
                "operating_point": [p],
                "sample_time": SAMPLE_TIME,
                "period": PERIOD,
                "input_is_one_period": True,
                "samples": PERIODS * PERIOD,
            }
        )
        arrays[f"{part}{number}_u"] = u[m, :, 0]
        if part == "fitted":
            arrays[f"fitted{number}_y"] = y[m]
    return entry, arrays, np.tile(steady[5:], (1, PERIODS))


def impedance_case(name: str, inductance: float, seed: int) -> tuple[dict[str, Any], dict[str, np.ndarray], np.ndarray]:
    """A cell R₀ + R(p)/(1 + jωRC) + jωL without variances: its entry, its arrays, the responses held out."""
    generator = np.random.default_rng(seed)
    omega = 2 * np.pi * np.geomspace(0.05, 2000, 40)

    def impedance(charge: float) -> np.ndarray:
        resistance = 0.03 + 0.0002 * charge
        return np.asarray(0.05 + resistance / (1 + 1j * omega * 0.02) + 1j * omega * inductance)

    points = [10.0, 50.0, 90.0, 30.0]
    noise = 1 + 5e-4 * (generator.standard_normal((4, 40)) + 1j * generator.standard_normal((4, 40)))
    entry: dict[str, Any] = {
        "case": name,
        "input": {"quantity": "current", "unit": "A"},
        "output": {"quantity": "voltage", "unit": "V"},
        "input_between_samples": None,
        "closed_loop": False,
        "structure": {"n_a": 1, "n_b": 1, "n_k": 0, "sample_time": None, "frequency_scale": 50.0},
        "scheduling": {"name": "soc", "unit": "%", "minimum": 0.0, "maximum": 100.0},
        "polynomial_degrees": [0, 1, 1],
        "theta_start": [1.0, 0.05, 0.0, 0.08, 0.0002],
        "experiments": [{"part": "fitted", "operating_point": [p]} for p in points[:3]]
        + [{"part": "held_out", "operating_point": [points[3]]}],
    }
    arrays = {f"fitted{m}_omega": omega for m in range(3)} | {"held_out0_omega": omega}
    arrays |= {f"fitted{m}_response": impedance(p) * noise[m] for m, p in enumerate(points[:3])}
    return entry, arrays, impedance(points[3])
