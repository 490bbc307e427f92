"""What is wrong with how a stage depends on its operating point, or with what was logged of it."""

from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import band_limited, integrate
from benchmarks.campaigns.stage import FITTED, HELD_OUT, PERIOD, PERIODS, SETTLING, Stage, no_law, stage
from identification.arrays import FloatArray

SAMPLES = PERIOD * PERIODS


def _springs(
    case: str,
    truth: Truth,
    plant: Stage,
    g: np.random.Generator,
    fitted: Sequence[float],
    held_out: Sequence[float],
    spring: Callable[[float, bool], float],
    logged: Sequence[float] | None = None,
) -> Campaign:
    """Steady records at shares of the travel, each with a spring of its own; `logged` is what was written down."""
    shares = [*fitted, *held_out]
    amplitudes, lines = plant.multisine(len(shares), g)
    omega = plant.frequencies(lines)
    time = plant.sample_time * np.arange(SAMPLES)
    waves = np.exp(1j * np.multiply.outer(time, omega))
    made = campaign(case, truth, plant.said())
    said = [*(fitted if logged is None else logged), *held_out]
    for e, share in enumerate(shares):
        part = "fitted" if e < len(fitted) else "held_out"
        answer = plant.response(0.0, omega, spring(share, part == "fitted")) * amplitudes[:, e]
        y = np.real(waves @ answer)
        y = plant.noisy(y, g) if part == "fitted" else y
        u = np.real(waves[:PERIOD] @ amplitudes[:, e])
        made.record(plant.at(said[e]), u, y, plant.sample_time, PERIOD, part)
    return made


def misplaced_point(case: str, g: np.random.Generator) -> Campaign:
    """One of six records was made elsewhere than it says."""
    plant = stage(g)
    points = np.linspace(0, 1, 6)
    wrong = int(g.integers(0, 6))
    off = g.uniform(0.06, 0.25) * (1 if points[wrong] < 0.5 else -1)
    made_at = points.copy()
    made_at[wrong] += off
    truth = Truth(("misplaced_point",), at=float(plant.at(points[wrong])))
    return _springs(case, truth, plant, g, made_at, HELD_OUT, lambda p, _: float(plant.spring(plant.at(p))), points)


def low_basis(case: str, g: np.random.Generator) -> Campaign:
    """The stiffness goes as 1/(1 + c p), the model is linear in p."""
    plant, bend = stage(g), g.uniform(0.5, 2.0)
    truth = Truth(("low_basis", "quadratic_dependence"))
    points = np.linspace(0, 1, 7)
    return _springs(case, truth, plant, g, points, HELD_OUT, lambda p, _: plant.stiffness / (1 + bend * p))


def three_points(case: str, g: np.random.Generator) -> Campaign:
    """The stiffness is quadratic in p and there are three points."""
    plant, bend = stage(g), g.uniform(0.1, 0.4)
    truth = Truth(("quadratic_dependence", "low_basis"))
    spring = lambda p, _: plant.stiffness * (1 - plant.softer * p + bend * p**2)  # noqa: E731
    return _springs(case, truth, plant, g, np.linspace(0, 1, 3), HELD_OUT, spring)


def temperature_not_logged(case: str, g: np.random.Generator) -> Campaign:
    """The stiffness varies from record to record with something that nobody wrote down."""
    plant, size = stage(g), g.uniform(0.03, 0.1)

    def spring(p: float, fitted: bool) -> float:
        return float(plant.spring(plant.at(p))) * (1 + fitted * size * g.standard_normal())

    return _springs(case, Truth(("record_variation",)), plant, g, np.repeat(FITTED, 2), [], spring)


def stiffness_drifts(case: str, g: np.random.Generator) -> Campaign:
    """The stiffness changes within each record."""
    plant, size = stage(g), g.uniform(0.01, 0.04) * g.choice([-1, 1])
    shares = np.array([*np.repeat(FITTED, 2), *HELD_OUT])
    p, drifts = plant.at(shares), np.arange(10) < 8
    amplitudes, lines = plant.multisine(10, g)
    force = band_limited(amplitudes, lines, PERIOD)
    begin, span = SETTLING * PERIOD * plant.sample_time, SAMPLES * plant.sample_time

    def spring(t: float) -> FloatArray:
        return np.asarray(plant.spring(p) * (1 + drifts * size * (2 * (t - begin) / span - 1) * (t >= begin)))

    drive = np.tile(force, (SETTLING + PERIODS, 1, 1))
    states = integrate(plant.slope(p, no_law, spring), np.zeros((2, 10)), drive, plant.sample_time)
    truth = Truth(("drifting_parameter", "record_variation"), nothing_is_right=True)
    made = campaign(case, truth, plant.said())
    for e in range(10):
        y = states[SETTLING * PERIOD :, 0, e]
        part = "fitted" if e < 8 else "held_out"
        made.record(p[e], force[:, 0, e], plant.noisy(y, g) if e < 8 else y, plant.sample_time, PERIOD, part)
    return made
