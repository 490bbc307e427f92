"""Plants with varying scheduling and what is measured of them, as requests."""

import numpy as np

from benchmarks.affine_plant import AffinePlant
from benchmarks.wind_turbine_plant import PLANT, scheduling
from identification.arrays import FloatArray
from identification.scheduling import SchedulingVariable
from tests.support.api import Json

PERIOD, PERIODS, NOISE = 120, 25, 0.1
TURBINE: Json = {
    "name": "wind turbine blade",
    "schedulingVariables": [{"name": "cosine", "unit": "1", "minimum": -1.0, "maximum": 1.0}],
    "inputs": [{"name": "pitch"}],
    "outputs": [{"name": "flapping"}],
    "structure": {"timeDomain": "discreteStateSpace", "sampleTimeSeconds": 1.0, "order": 2},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
COX: Json = {
    **TURBINE,
    "name": "random system",
    "schedulingVariables": [{"name": name, "minimum": -1.0, "maximum": 1.0} for name in ("load", "speed")],
    "inputs": [{"name": "u1"}, {"name": "u2"}],
    "outputs": [{"name": "y1"}, {"name": "y2"}],
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}] * 2},
}

Signals = tuple[FloatArray, FloatArray, FloatArray]


def cox_plant() -> AffinePlant:
    """Two inputs, two outputs, two scheduling variables, stable for all |p_i| ≤ 1; D = 0."""
    g = np.random.default_rng(4)
    a = g.standard_normal((3, 2, 2))
    a *= (np.array([0.6, 0.15, 0.15]) / np.linalg.norm(a, 2, axis=(1, 2)))[:, None, None]
    b, c = g.standard_normal((2, 3, 2, 2))
    variables = tuple(SchedulingVariable(name, "", -1.0, 1.0) for name in ("load", "speed"))
    return AffinePlant(a, b, c, np.zeros((3, 2, 2)), 1.0, variables)


def turbine(seed: int = 1, noise: float = NOISE, period: int = PERIOD, periods: int = PERIODS) -> Signals:
    """A multisine that repeats itself together with p(t) = cos(2πt/10), from rest."""
    g = np.random.default_rng(seed)
    lines = np.zeros(period // 2 + 1, dtype=complex)
    lines[1:-1] = np.exp(2j * np.pi * g.random(period // 2 - 1))
    wave = np.fft.irfft(lines, period)
    u = np.tile(wave / wave.std(), periods)[:, None]
    return measured(PLANT, u, scheduling(len(u)), noise, g)


def white(model: AffinePlant, samples: int, seed: int = 1, noise: float = 0.02) -> Signals:
    """White input and scheduling that never repeat themselves."""
    g = np.random.default_rng(seed)
    u, p = g.standard_normal((samples, model.n_inputs)), g.uniform(-1, 1, (samples, model.n_scheduling))
    return measured(model, u, p, noise, g)


def measured(model: AffinePlant, u: FloatArray, p: FloatArray, noise: float, generator: np.random.Generator) -> Signals:
    """u, y with white noise, p."""
    y = model.simulate(u, p)
    return u, y + noise * generator.standard_normal(y.shape), p


def body(plant: Json, signals: Signals, **more: object) -> Json:
    """The request that brings a record in as JSON."""
    u, y, p = (signal.T.tolist() for signal in signals)
    named = {"plantId": plant["id"], "kind": "varyingRecord", "sampleTimeSeconds": 1.0}
    return {**named, "inputs": u, "outputs": y, "scheduling": p, **more}


def still(point: float, seed: int, samples: int = 100, periods: int = 12, gain: float = 1.0) -> Json:
    """The turbine with its scheduling held still, as a periodic time record without its plant."""
    u, y, _ = _still_signals(point, seed, samples, periods)
    return {
        "kind": "timeRecord",
        "operatingPoint": [point],
        "sampleTimeSeconds": 1.0,
        "periodSamples": samples,
        "input": u.tolist(),
        "output": (gain * y).tolist(),
    }


def _still_signals(point: float, seed: int, samples: int, periods: int) -> Signals:
    g = np.random.default_rng([seed, round(1000 * point) + 5000])
    u = np.tile(g.standard_normal(samples), periods + 1)[:, None]
    signals = measured(PLANT, u, np.full((len(u), 1), point), NOISE, g)
    first, second, third = (signal[samples:, 0] for signal in signals)
    return first, second, third
