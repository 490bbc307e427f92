"""A stage under inputs that do not repeat: white noise, random telegraphs, steps, chirps, held between samples."""

from collections.abc import Callable

import numpy as np
from scipy.signal import chirp, max_len_seq

from benchmarks.campaigns import laws
from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import held, integrate
from benchmarks.campaigns.stage import FITTED, HELD_OUT, Law, Stage, no_law, stage
from identification.arrays import FloatArray

SAMPLES = 2048


def _white(plant: Stage, g: np.random.Generator) -> FloatArray:
    return g.standard_normal(SAMPLES)


def _telegraph(plant: Stage, g: np.random.Generator) -> FloatArray:
    bits = np.repeat(max_len_seq(11, (g.permutation(11) > 4).astype(int))[0], 2)[:SAMPLES]
    return 2.0 * bits - 1


def _steps(plant: Stage, g: np.random.Generator) -> FloatArray:
    dwell = int(g.integers(30, 80))
    return np.repeat(g.standard_normal(SAMPLES // dwell + 1), dwell)[:SAMPLES]


def _chirp(plant: Stage, g: np.random.Generator) -> FloatArray:
    resonance = np.sqrt(plant.stiffness / plant.mass) / (2 * np.pi)
    t = plant.sample_time * np.arange(SAMPLES)
    return np.sqrt(2) * chirp(t, 0.1 * resonance, t[-1], g.uniform(1.8, 2.5) * resonance, phi=360 * g.random())


def _recorded(
    case: str,
    truth: Truth,
    g: np.random.Generator,
    input: Callable[[Stage, np.random.Generator], FloatArray],
    law: Callable[[Stage, float, float], Law] = lambda plant, q, v: no_law,
    order: int = 0,
) -> Campaign:
    plant = stage(g, order)
    p = plant.at(np.array([*FITTED, *HELD_OUT]))
    u = np.stack([input(plant, g) for _ in p], axis=1)
    drive = held(u)
    linear = integrate(plant.slope(p, no_law), np.zeros((2, len(p))), drive, plant.sample_time)
    hidden = law(plant, *(float(x) for x in linear.std(axis=(0, 2))))
    states = integrate(plant.slope(p, hidden), np.zeros((2, len(p))), drive, plant.sample_time)
    y = plant.measured(states, u, p, hidden)
    made = campaign(case, truth, plant.said_sampled())
    for e, point in enumerate(p):
        fitted = e < len(FITTED)
        seen = plant.noisy(y[:, e], g) if fitted else y[:, e]
        made.record(point, u[:, e], seen, plant.sample_time, None, "fitted" if fitted else "held_out")
    return made


def _coulomb(case: str, g: np.random.Generator, input: Callable[[Stage, np.random.Generator], FloatArray]) -> Campaign:
    force = g.uniform(0.05, 0.2)
    truth = Truth(("coulomb_friction",), amplitude=force)
    return _recorded(case, truth, g, input, lambda plant, q, v: laws.coulomb(force, v))


def white_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction under white noise."""
    return _coulomb(case, g, _white)


def telegraph_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction under a pseudo-random telegraph."""
    return _coulomb(case, g, _telegraph)


def steps_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction under steps."""
    return _coulomb(case, g, _steps)


def chirp_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction under a chirp."""
    return _coulomb(case, g, _chirp)


def _drawn(g: np.random.Generator) -> Callable[[Stage, np.random.Generator], FloatArray]:
    return (_white, _telegraph, _steps, _chirp)[int(g.integers(4))]


def free_cubic(case: str, g: np.random.Generator) -> Campaign:
    """A hardening spring under any of these inputs."""
    share = g.uniform(0.02, 0.2)
    found = []

    def law(plant: Stage, q: float, v: float) -> Law:
        found.append(share * plant.stiffness / q**2)
        return laws.power(found[0], 3)

    made = _recorded(case, Truth(), g, _drawn(g), law)
    made.truth = Truth(("cubic_stiffness",), amplitude=found[0])
    return made


def white_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden under white noise."""
    return _recorded(case, Truth(nothing_is_right=True), g, _white)


def steps_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden under steps."""
    return _recorded(case, Truth(nothing_is_right=True), g, _steps)


def chirp_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden under a chirp."""
    return _recorded(case, Truth(nothing_is_right=True), g, _chirp)
