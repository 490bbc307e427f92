"""A mass with dry friction, integrated from event to event: it slips one way, sticks, or slips the other way.

Nothing is smoothed: while it slips friction is a known force and Runge–Kutta's method is used; where the velocity comes
to zero within a step the step ends there; the mass then sticks until what pulls at it is more than friction can hold.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

STEPS = 12


@dataclass(frozen=True)
class Plant:
    """m q̈ + c q̇ + k q + friction = u; `friction` (direction, q̇) is its size, that at rest is what holds."""

    mass: float
    damping: float
    stiffness: float
    friction: Callable[[float, float], float] = lambda direction, v: 0.0
    spring: Callable[[float], float] = lambda q: 0.0


def coulomb(size: float) -> Callable[[float, float], float]:
    """The same at every speed."""
    return lambda direction, v: size


def stribeck(size: float, excess: float, speed: float) -> Callable[[float, float], float]:
    """More at low speed."""
    return lambda direction, v: size * (1 + excess * np.exp(-((v / speed) ** 2)))


def asymmetric(forwards: float, backwards: float) -> Callable[[float, float], float]:
    """Another size each way."""
    return lambda direction, v: forwards if direction > 0 else backwards


def followed(plant: Plant, force: np.ndarray, sample_time: float, feedback=None) -> tuple[np.ndarray, np.ndarray]:
    """q and q̇ at N samples, from rest, for a force on the grid of half steps (2·STEPS·N,), or one value a sample (N,).

    `feedback` (q, q̇, n): what a controller adds to the force at sample n and holds.
    """
    held = len(force) % (2 * STEPS) != 0 or feedback is not None
    count = len(force) if held else len(force) // (2 * STEPS)
    q = v = 0.0
    h, out = sample_time / STEPS, np.empty((2, count))
    values = np.append(force, force[-1]).tolist()
    for n in range(count):
        out[:, n] = q, v
        added = 0.0 if feedback is None else feedback(q, v, n)
        for i in range(STEPS):
            at = n if held else 2 * (n * STEPS + i)
            u = (values[n] + added,) * 3 if held else (values[at], values[at + 1], values[(at + 2) % len(force)])
            q, v = _step(plant, q, v, u, h)
    return out[0], out[1]


def _step(plant: Plant, q: float, v: float, u: tuple[float, float, float], h: float) -> tuple[float, float]:
    begin = 0.0
    for _ in range(20):
        if v == 0.0:
            pull = _input(u, begin) - plant.stiffness * q - plant.spring(q)
            direction = 1.0 if pull > 0 else -1.0
            if abs(pull) <= plant.friction(direction, 0.0):
                return q, 0.0
        else:
            direction = 1.0 if v > 0 else -1.0
        q1, v1 = _slip(plant, q, v, u, begin, 1.0, h, direction)
        if v1 * direction >= 0 or begin > 1 - 1e-9:
            return q1, v1
        end = _stop(plant, q, v, u, begin, h, direction)
        q, v = _slip(plant, q, v, u, begin, end, h, direction)[0], 0.0
        if end - begin < 1e-9:
            return q, 0.0
        begin = end
    return q, v


def _stop(plant, q, v, u, begin, h, direction):
    """Where in the step the velocity comes to zero, by bisection and then the chord."""
    low, high = begin, 1.0
    for _ in range(24):
        middle = 0.5 * (low + high)
        if _slip(plant, q, v, u, begin, middle, h, direction)[1] * direction > 0:
            low = middle
        else:
            high = middle
    return high


def _input(u, s):
    """The force at the part s of a step, through its beginning, middle and end."""
    return u[0] + s * (-3 * u[0] + 4 * u[1] - u[2]) + 2 * s * s * (u[0] - 2 * u[1] + u[2])


def _slip(plant, q, v, u, begin, end, h, direction):
    """One step of Runge–Kutta's method from one part of a step to another, friction against the direction."""
    d = (end - begin) * h
    u0, u1, u2 = _input(u, begin), _input(u, 0.5 * (begin + end)), _input(u, end)

    def rate(x, w, f):
        holding = direction * plant.friction(direction, w)
        return (f - plant.stiffness * x - plant.spring(x) - plant.damping * w - holding) / plant.mass

    a0 = rate(q, v, u0)
    a1 = rate(q + d / 2 * v, v + d / 2 * a0, u1)
    a2 = rate(q + d / 2 * (v + d / 2 * a0), v + d / 2 * a1, u1)
    a3 = rate(q + d * (v + d / 2 * a1), v + d * a2, u2)
    return q + d * v + d * d / 6 * (a0 + a1 + a2), v + d / 6 * (a0 + 2 * a1 + 2 * a2 + a3)
