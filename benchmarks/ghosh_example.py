"""The plant and the noise of the numerical example [Ghosh2018, Section 5], for the benchmarks."""

import numpy as np

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.channels import UNSTATED
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from identification.simulation import simulate

STRUCTURE = RationalStructure(n_a=1, n_b=0, n_k=1, n_c=0, n_d=1, sample_time=1.0)
DEPENDENCE = ParameterDependence(
    (SchedulingVariable("p", "", 0.0, 8.0),), tuple(ProductBasis((Polynomial(1),)) for _ in range(STRUCTURE.size))
)
THETA = np.array([-0.9, 0.1, 10.0, -1.0, -0.7, 0.08])
NOISE_VARIANCE = 0.5
DEVIATIONS = (0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3)
GRID = np.arange(0.0, 8.5, 0.5)[:, None]
ACCEPTED = 12.6


def measured(point: tuple[float, ...], u: FloatArray, generator: np.random.Generator) -> TimeRecord:
    """The record of the plant at an operating point for an input u (N,), from rest."""
    zeta = (DEPENDENCE.matrix([point]) @ THETA)[0]
    noise = generator.standard_normal(len(u)) * np.sqrt(NOISE_VARIANCE)
    return TimeRecord(u, simulate(STRUCTURE, zeta, u, noise), 1.0, point, channels=UNSTATED.at_level(0.0))
