"""Simulated plants for tests of identification: the example of the paper, and random Box–Jenkins systems."""

from dataclasses import dataclass

import numpy as np

from identification.bases.polynomial import Polynomial
from identification.channels import UNSTATED
from identification.models.rational import RationalStructure, roots
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from identification.simulation import simulate

EXAMPLE = RationalStructure(n_a=1, n_b=0, n_k=1, n_c=0, n_d=1, sample_time=1.0)
THETA = np.array([-0.9, 0.1, 10.0, -1.0, -0.7, 0.08])
P = SchedulingVariable("p", "V", 0.0, 8.0)
AT_ZERO = UNSTATED.at_level(0.0)  # the levels of a simulated plant are known


def polynomial_dependence(*degrees: int) -> ParameterDependence:
    return ParameterDependence((P,), tuple(ProductBasis((Polynomial(degree),)) for degree in degrees))


DEPENDENCE = polynomial_dependence(1, 1, 1)


def zeta_of_example(p: float) -> np.ndarray:
    return np.array([-0.9 + 0.1 * p, 10.0 - p, -0.7 + 0.08 * p])


def example_record(p: float, generator, samples: int = 1000, power: float = 0.75, noise: float = 0.5) -> TimeRecord:
    """White input at an operating point of the example, from rest."""
    u = generator.standard_normal(samples) * np.sqrt(power)
    e = generator.standard_normal(samples) * np.sqrt(noise)
    return TimeRecord(u, simulate(EXAMPLE, zeta_of_example(p), u, e), 1.0, (p,), channels=AT_ZERO)


def steady_record(p: float, indices, generator, samples: int = 1000, noise: float = 0.5) -> TimeRecord:
    """Lines of a record at an operating point of the example, in the steady state."""
    phases = 2 * np.pi * np.outer(indices, np.arange(samples)) / samples
    u = np.cos(phases + np.arange(len(indices))[:, None]).sum(axis=0)
    zeta = zeta_of_example(p)
    e = generator.standard_normal(samples) * np.sqrt(noise)
    v = simulate(EXAMPLE, np.array([0.0, 0.0, zeta[2]]), u, e)
    return TimeRecord(u, simulate(EXAMPLE, zeta, u, periodic=True) + v, 1.0, (p,), channels=AT_ZERO)


@dataclass(frozen=True, eq=False)
class Case:
    structure: RationalStructure
    zeta: np.ndarray
    record: TimeRecord
    snr: float


def random_polynomial(generator, order: int, largest: float) -> np.ndarray:
    zeros: list[complex] = []
    while len(zeros) < order:
        radius = generator.uniform(0.0, largest)
        if order - len(zeros) >= 2 and generator.random() < 0.6:
            z = radius * np.exp(1j * generator.uniform(0.05, 3.0))
            zeros += [z, z.conj()]
        else:
            zeros.append(radius * generator.choice([-1, 1], p=[0.25, 0.75]))
    return np.poly(zeros).real if order else np.ones(1)


def apart(one: np.ndarray, other: np.ndarray, distance: float = 0.15) -> bool:
    """Whether no zero of one polynomial nearly cancels one of the other."""
    if not len(one) or not len(other):
        return True
    return bool(np.abs(roots(one)[:, None] - roots(other)[None]).min() > distance)


def random_case(seed: int, samples=(300, 1000, 2000), snr=(-10.0, 60.0)) -> Case | None:
    """A random system of orders up to 4 with a record; None when poles and zeros nearly cancel."""
    g = np.random.default_rng(seed)
    n_a = int(g.integers(0, 5))
    n_b, n_k = int(g.integers(0, max(n_a, 1) + 1)), int(g.integers(0, 4))
    n_c, n_d = int(g.integers(0, 4)), int(g.integers(0, 4))
    structure = RationalStructure(n_a, n_b, n_k, n_c, n_d, sample_time=1.0)
    a, b = random_polynomial(g, n_a, 0.98), g.standard_normal(n_b + 1)
    c, d = random_polynomial(g, n_c, 0.95), random_polynomial(g, n_d, 0.95)
    if not (apart(c[1:], d[1:]) and apart(a[1:], b[1:] / b[0])):
        return None
    zeta = np.concatenate([a[1:], b, c[1:], d[1:]])
    count = int(g.choice(samples))
    u = g.standard_normal(count) if g.integers(2) else np.sign(g.standard_normal(count))
    clean = simulate(structure, zeta, u)
    plant = np.concatenate([np.zeros(structure.n_plant), zeta[structure.n_plant :]])
    disturbance = simulate(structure, plant, u, g.standard_normal(count))
    ratio = g.uniform(*snr)
    scale = np.std(clean) / np.std(disturbance) * 10 ** (-ratio / 20)
    return Case(structure, zeta, TimeRecord(u, clean + scale * disturbance, 1.0, (0.0,)), ratio)
