"""Loops computed sample by sample: x(t+1) = 0.95 x + 0.5 u, y = x + v, under controllers that act on y."""

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from identification.signals import TimeRecord

SLOW = ((1.0,), (1.0, -0.95))
RESONANT = ((1.0, 0.7), (1.0, -1.6, 0.8))
WHITE = ((1.0,), (1.0,))
Controller = Callable[[np.ndarray, int], float]


def proportional(gain: float) -> Controller:
    """What is taken off the reference for the outputs up to and with y(t)."""
    return lambda y, t: gain * y[t]


def late(gain: float, lag: int) -> Controller:
    return lambda y, t: gain * y[t - lag] if t >= lag else 0.0


def integral(gain: float, rate: float) -> Controller:
    """A PI controller that keeps its own sum."""
    state = [0.0]

    def act(y: np.ndarray, t: int) -> float:
        state[0] += rate * y[t]
        return gain * y[t] + state[0]

    return act


def looped(
    r: np.ndarray,
    v: np.ndarray,
    controller: Controller,
    pole: float = 0.95,
    direct: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """u and y (N,) of u = r − controller(y); with a `direct` path the controller must be late."""
    u, y, x = np.zeros(len(r)), np.zeros(len(r)), 0.0
    for t in range(len(r)):
        y[t] = x + v[t]
        u[t] = r[t] - controller(y, t)
        y[t] += direct * u[t]
        x = pole * x + 0.5 * u[t]
    return u, y


def in_loop(
    seed: int,
    noise: tuple[tuple[float, ...], tuple[float, ...]] = SLOW,
    controller: Controller | None = None,
    samples: int = 8192,
    size: float = 1.0,
    **stated: object,
) -> TimeRecord:
    """A record in the loop u = r − controller(y) with white r; in the open for no controller."""
    g = np.random.default_rng(seed)
    r = g.standard_normal(samples)
    v = lfilter(*noise, size * g.standard_normal(samples))
    u, y = looped(r, v, controller or (lambda y, t: 0.0))
    if stated.pop("reference", False):
        stated["reference"] = r
    return TimeRecord(u, y, 1.0, (0.0,), **stated)
