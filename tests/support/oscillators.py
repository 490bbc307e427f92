"""A small second-order plant with p-dependent stiffness, and records of it made by direct filtering or Runge–Kutta."""

import numpy as np
from scipy.integrate import solve_ivp

from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord

PERIOD, SAMPLE_TIME = 128, 0.1
LINES = np.array([1, 3, 5, 7, 9, 11, 13, 17, 19, 23])
OMEGA = 2 * np.pi * LINES / (PERIOD * SAMPLE_TIME)
DEPENDENCE = ParameterDependence(
    (SchedulingVariable("p", "1", -1.0, 1.0),), tuple(ProductBasis((Polynomial(n),)) for n in (0, 1, 0))
)
THETA = np.array([1.5, 30.0, 10.0, 1.0])
MODEL = Model(RationalStructure(2, 0), DEPENDENCE, THETA, 1e-12 * np.eye(4), 1.0)
POINTS = (-1.0, -0.5, 0.0, 0.5, 1.0)


def phasors(generator, level=8.0):
    """Amplitudes of the lines of a random-phase multisine of this root mean square."""
    return level * np.sqrt(2 / len(LINES)) * np.exp(2j * np.pi * generator.random(len(LINES)))


def played(amplitudes, t):
    """The multisine at the times t."""
    return np.real(np.exp(1j * np.multiply.outer(t, OMEGA)) @ amplitudes)


def linear(p, amplitudes, extra=None):
    """The steady output at the samples of one period; `extra` (ω → complex) multiplies the response."""
    response = 1 / (30 + 10 * p - OMEGA**2 + 1.5j * OMEGA)
    if extra is not None:
        response = response * extra(OMEGA)
    return played(response * amplitudes, np.arange(PERIOD) * SAMPLE_TIME)


def integrated(p, amplitudes, force, gain=lambda u: u):
    """The steady output with a force f(x, v) taken off the input, by an adaptive integrator."""

    def slope(t, s):
        return [s[1], gain(played(amplitudes, t)) - (30 + 10 * p) * s[0] - 1.5 * s[1] - force(s[0], s[1])]

    duration = PERIOD * SAMPLE_TIME
    times = duration + np.arange(PERIOD) * SAMPLE_TIME
    return solve_ivp(slope, (0, 2 * duration), [0, 0], t_eval=times, rtol=1e-9, atol=1e-11, method="DOP853").y[0]


def records(outputs, generator, sigma, periods=4, points=POINTS, colour=0.0):
    """Noisy records; `outputs` (amplitudes, output) for each point."""
    found = []
    for p, (amplitudes, y) in zip(points, outputs, strict=True):
        noise = generator.standard_normal(periods * PERIOD)
        for t in range(1, len(noise) if colour else 0):
            noise[t] += colour * noise[t - 1]
        u = np.tile(played(amplitudes, np.arange(PERIOD) * SAMPLE_TIME), periods)
        found.append(TimeRecord(u, np.tile(y, periods) + sigma * noise, SAMPLE_TIME, (p,), PERIOD))
    return found


def clean_records(seed=0, sigma=1e-3, extra=None, **options):
    """Records of the plant as the model has it, or with a factor in its response."""
    generator = np.random.default_rng(seed)
    inputs = [phasors(generator) for _ in POINTS]
    return records([(a, linear(p, a, extra)) for p, a in zip(POINTS, inputs, strict=True)], generator, sigma, **options)


def batches(seed=0, sigma=1e-3, extra=None, **options):
    """The same, gathered."""
    return gather(clean_records(seed, sigma, extra, **options))
