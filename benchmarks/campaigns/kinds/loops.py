"""Plants under feedback: a stage, an axis that integrates, a magnetic bearing that falls without its loop."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.campaigns import laws
from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from benchmarks.campaigns.integrator import controlled
from benchmarks.campaigns.stage import Law, Stage, no_law, stage
from identification.arrays import FloatArray

PERIOD, PERIODS, SETTLING = 512, 4, 3
SHARES = np.array([0.0, 0.0, 1 / 3, 2 / 3, 1.0, 1.0, 0.2, 0.75])
FITTED = 6


@dataclass(frozen=True)
class _Loop:
    """m(p) q″ + d q′ + k(p) q + f(q, q′) = g F under F = r − K q − D q′ with the rate from the last two samples."""

    said: dict[str, Any]
    points: FloatArray
    mass: FloatArray
    damping: float
    spring: FloatArray
    gain: float
    proportional: float
    derivative: float
    sample_time: float
    noise: float
    band: float

    def run(self, g: np.random.Generator, law: Law, silent: bool = False) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Reference, applied input and output as measured (N, E) over PERIODS settled periods."""
        lines = np.arange(1, int(self.band * PERIOD * self.sample_time / (2 * np.pi)))
        amplitudes = np.sqrt(2 / len(lines)) * np.exp(2j * np.pi * g.random((len(lines), len(self.points))))
        wave = np.real(np.exp(2j * np.pi * np.outer(np.arange(PERIOD), lines) / PERIOD) @ amplitudes)
        samples = (SETTLING + PERIODS) * PERIOD
        size, last = self.noise, np.zeros(len(self.points))
        disturbance = 0.0 if silent else size * g.standard_normal((samples, len(self.points)))
        seen = np.zeros((samples, len(self.points)))

        def controller(n: int, x: FloatArray) -> FloatArray:
            nonlocal last
            seen[n] = x[0] + (0.0 if silent else disturbance[n])
            rate, last = (seen[n] - last) / self.sample_time, seen[n].copy()
            return np.asarray(wave[n % PERIOD] - self.proportional * seen[n] - self.derivative * rate)

        def slope(x: FloatArray, u: FloatArray, t: float) -> FloatArray:
            force = self.gain * u - self.damping * x[1] - self.spring * x[0] - law(x[0], x[1])
            return np.stack([x[1], force / self.mass])

        _, applied = controlled(slope, np.zeros((2, len(self.points))), samples, self.sample_time, controller)
        keep = slice(SETTLING * PERIOD, None)
        return np.tile(wave, (PERIODS, 1)), applied[keep], seen[keep]


def _looped(
    case: str,
    truth: Callable[[float, float], Truth],
    loop: _Loop,
    g: np.random.Generator,
    law: Callable[[float, float], Law],
    reference_as_input: bool = False,
) -> Campaign:
    """Records in a loop, their noise sized by a silent run; what is held out is nearly without noise."""
    _, _, quiet = loop.run(np.random.default_rng(0), no_law, silent=True)
    q, v = float(quiet.std()), float(np.gradient(quiet, loop.sample_time, axis=0).std())
    noisy = _Loop(**(vars(loop) | {"noise": loop.noise * q}))
    calm = _Loop(**(vars(loop) | {"noise": 1e-5 * q}))
    made = campaign(case, truth(q, v), loop.said | {"closed_loop": True, "input_between_samples": "zero_order_hold"})
    for part, rig, which in (("fitted", noisy, range(FITTED)), ("held_out", calm, range(FITTED, len(SHARES)))):
        reference, applied, seen = rig.run(g, law(q, v))
        for e in which:
            u = reference[:PERIOD, e] if reference_as_input else applied[:, e]
            made.record(loop.points[e], u, seen[:, e], loop.sample_time, PERIOD, part)
    return made


def _stage_loop(g: np.random.Generator) -> _Loop:
    plant: Stage = stage(g)
    points = plant.at(SHARES)
    spring = plant.spring(points)
    resonance = float(np.sqrt(plant.stiffness / plant.mass))
    gain, noise = g.uniform(0.1, 0.4) * plant.stiffness, 10 ** g.uniform(-2.7, -1.9)
    mass = np.full(len(points), plant.mass)
    return _Loop(
        plant.said_sampled(),
        points,
        mass,
        plant.damping,
        spring,
        1.0,
        gain,
        0.0,
        plant.sample_time,
        noise,
        2 * resonance,
    )


def _axis(g: np.random.Generator) -> _Loop:
    """A drive that integrates; its mass grows with the load, its model has 1/m as a polynomial."""
    empty, growth, damping = g.uniform(0.5, 5.0), g.uniform(0.4, 1.0), g.uniform(2, 8)
    speed = g.uniform(10, 30)
    mass = empty * (1 + growth * SHARES)
    shares = np.linspace(0, 1, 101)
    inverse = np.polynomial.polynomial.polyfit(shares, 1 / (empty * (1 + growth * shares)), 3)
    scale = float(f"{speed:.1g}")
    said = {
        "input": {"quantity": "force", "unit": "N"},
        "output": {"quantity": "position", "unit": "m"},
        "structure": {"n_a": 2, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "load", "unit": "kg", "minimum": 0.0, "maximum": 1.0},
        "polynomial_degrees": [3, 0, 3],
        "theta_start": [*(damping * inverse / scale), 0.0, *(inverse / scale**2)],
    }
    proportional = empty * speed**2
    derivative = max(2 * 0.6 * empty * speed - damping, 0.1 * empty * speed)
    step = 0.1 / speed
    return _Loop(
        said, SHARES, mass, damping, 0 * mass, 1.0, proportional, derivative, step, 10 ** g.uniform(-3, -2.3), 3 * speed
    )


def _bearing(g: np.random.Generator) -> _Loop:
    """A shaft between magnets whose negative stiffness grows with the bias current."""
    mass, factor = g.uniform(0.3, 3.0), g.uniform(1000, 3000)
    points = 1 + 2 * SHARES
    spring, gain, damping = -factor * mass * points, 100 * mass * g.uniform(0.5, 2), g.uniform(2, 8) * mass
    scale = float(f"{np.sqrt(2 * factor):.1g}")
    said = {
        "input": {"quantity": "current", "unit": "A"},
        "output": {"quantity": "position", "unit": "m"},
        "structure": {"n_a": 2, "n_b": 0, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "bias", "unit": "A", "minimum": 1.0, "maximum": 3.0},
        "polynomial_degrees": [0, 1, 0],
        "theta_start": [damping / mass / scale, 0.0, -factor / scale**2, gain / mass / scale**2],
    }
    proportional = 2.5 * 3 * factor * mass / gain
    derivative = 1.0 * np.sqrt(4.5 * factor) * mass / gain
    step = 0.06 / np.sqrt(3 * factor)
    filled = np.full(len(SHARES), mass)
    return _Loop(
        said,
        points,
        filled,
        damping,
        spring,
        gain,
        proportional,
        derivative,
        step,
        10 ** g.uniform(-3.3, -2.5),
        2 * np.sqrt(3 * factor),
    )


def loop_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden; a proportional loop ran."""
    return _looped(case, lambda q, v: Truth(nothing_is_right=True), _stage_loop(g), g, lambda q, v: no_law)


def loop_reference_as_input(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden, but what is called the input is the reference."""
    return _looped(case, lambda q, v: Truth(nothing_is_right=True), _stage_loop(g), g, lambda q, v: no_law, True)


def loop_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction in a proportional loop."""
    force = g.uniform(0.05, 0.2)
    truth = Truth(("coulomb_friction",), amplitude=force)
    return _looped(case, lambda q, v: truth, _stage_loop(g), g, lambda q, v: laws.coulomb(force, v))


def axis_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden in an axis that integrates."""
    return _looped(case, lambda q, v: Truth(nothing_is_right=True), _axis(g), g, lambda q, v: no_law)


def axis_coulomb(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction in an axis that integrates."""
    force = g.uniform(0.08, 0.25)
    truth = Truth(("coulomb_friction",), amplitude=force)
    return _looped(case, lambda q, v: truth, _axis(g), g, lambda q, v: laws.coulomb(force, v))


def bearing_nothing(case: str, g: np.random.Generator) -> Campaign:
    """Nothing is hidden in a magnetic bearing."""
    return _looped(case, lambda q, v: Truth(nothing_is_right=True), _bearing(g), g, lambda q, v: no_law)


def bearing_cubic(case: str, g: np.random.Generator) -> Campaign:
    """A cubic spring in a magnetic bearing, in the unit of its current."""
    loop, share = _bearing(g), g.uniform(0.05, 0.3)
    stiff = float(np.mean(loop.gain * loop.proportional + loop.spring))

    def truth(q: float, v: float) -> Truth:
        return Truth(("cubic_stiffness",), amplitude=share * stiff / q**2 / loop.gain)

    return _looped(case, truth, loop, g, lambda q, v: laws.power(share * stiff / q**2, 3))
