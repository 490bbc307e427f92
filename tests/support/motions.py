"""A mass on a spring with whatever acts on it, integrated in small steps under held inputs, alone or in a loop."""

from collections.abc import Callable

import numpy as np
from scipy.signal import cont2discrete, ss2tf

from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord

Force = Callable[[np.ndarray, np.ndarray], np.ndarray]
Control = Callable[[int, np.ndarray], np.ndarray]

STEP, FINE, DAMPING, STIFFNESS = 0.05, 16, 2.4, 36.0
POINTS = np.array([0.0, 0.5, 1.0])


def nothing(x: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.zeros_like(x)


def integrated(
    u: Control,
    samples: int,
    force: Force = nothing,
    stiffness: float = STIFFNESS,
    start: tuple[float, float] = (0.0, 0.0),
    points: np.ndarray = POINTS,
) -> tuple[np.ndarray, np.ndarray]:
    """Inputs and positions (M, samples) of ẍ = 36 (1 + p/2)(u − f) − 2.4 ẋ − k x at the points (M,), by Runge–Kutta.

    `u(t, x)` (M,) is asked once a sample, with the position then, and held.
    """
    gain, h = STIFFNESS * (1 + points / 2), STEP / FINE
    x, v = (np.full(len(points), one) for one in start)
    inputs, positions = np.empty((2, len(points), samples))

    def slope(x: np.ndarray, v: np.ndarray, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return v, gain * (held - force(x, v)) - DAMPING * v - stiffness * x

    for t in range(samples):
        held = u(t, x)
        inputs[:, t], positions[:, t] = held, x
        for _ in range(FINE):
            x1, v1 = slope(x, v, held)
            x2, v2 = slope(x + h / 2 * x1, v + h / 2 * v1, held)
            x3, v3 = slope(x + h / 2 * x2, v + h / 2 * v2, held)
            x4, v4 = slope(x + h * x3, v + h * v3, held)
            x, v = x + h / 6 * (x1 + 2 * x2 + 2 * x3 + x4), v + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
    return inputs, positions


def played(signals: np.ndarray) -> Control:
    """The input (M, samples) as it is."""
    return lambda t, x: signals[:, t]


def model(stiffness: float = STIFFNESS) -> Model:
    """The plant as it is sampled, its gain linear in p; a little off, as a user's would be."""
    matrices = np.array([[0, 1], [-stiffness, -DAMPING]]), np.array([[0], [STIFFNESS]]), np.eye(1, 2), np.zeros((1, 1))
    b, a = ss2tf(*cont2discrete(matrices, STEP)[:4])
    theta = np.concatenate([a[1:], np.ravel([[one, one / 2] for one in b[0, 1:]])]) * 1.002
    bases = tuple(ProductBasis((Polynomial(degree),)) for degree in (0, 0, 1, 1))
    dependence = ParameterDependence((SchedulingVariable("p", "V", 0.0, 1.0),), bases)
    return Model(RationalStructure(2, 1, 1, sample_time=STEP), dependence, theta, np.eye(6), 1.0)


def continuous(stiffness: float = STIFFNESS) -> Model:
    """The same as a differential equation, in powers of s/6."""
    bases = tuple(ProductBasis((Polynomial(degree),)) for degree in (0, 0, 1))
    dependence = ParameterDependence((SchedulingVariable("p", "V", 0.0, 1.0),), bases)
    theta = np.array([DAMPING / 6, stiffness / 36, 1.0, 0.5])
    return Model(RationalStructure(2, 0, frequency_scale=6.0), dependence, theta, np.eye(4), 1.0)


def records(
    inputs: np.ndarray, outputs: np.ndarray, noise: float, generator: np.random.Generator, **stated: object
) -> list[TimeRecord]:
    """Records with white noise, `noise` of the root mean square of all outputs."""
    deviation = noise * np.std(outputs)
    return [
        TimeRecord(u, y + deviation * generator.standard_normal(len(y)), STEP, (float(p),), hold="zero", **stated)
        for p, u, y in zip(POINTS, inputs, outputs, strict=True)
    ]


def white(generator: np.random.Generator, samples: int) -> np.ndarray:
    return generator.standard_normal((len(POINTS), samples))


def two_levels(generator: np.random.Generator, samples: int) -> np.ndarray:
    held = np.sign(generator.standard_normal((len(POINTS), -(-samples // 4))))
    return np.repeat(held, 4, axis=1)[:, :samples]


def steps(generator: np.random.Generator, samples: int) -> np.ndarray:
    levels = generator.uniform(-2, 2, (len(POINTS), -(-samples // 40)))
    return np.repeat(levels, 40, axis=1)[:, :samples]


def chirp(generator: np.random.Generator, samples: int) -> np.ndarray:
    t = np.arange(samples) * STEP
    phase = 0.3 * t + 0.5 * 20.0 * t**2 / t[-1]
    return 1.4 * np.sin(phase + generator.uniform(0, 2 * np.pi, (len(POINTS), 1)))


INPUTS = {"white": white, "two_levels": two_levels, "steps": steps, "chirp": chirp}
