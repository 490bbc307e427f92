"""Models that the tests of the report share."""

import numpy as np

from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

SPEED = SchedulingVariable("n", "1/s", 0.0, 2.0)
POINTS = np.linspace(0.0, 2.0, 21)[:, None]


def resonance(sample_time: float | None = 0.5) -> Model:
    """Two complex poles that move with the speed; in continuous time when there is no sample time."""
    structure = RationalStructure(n_a=2, n_b=0, n_k=0 if sample_time is None else 1, sample_time=sample_time)
    dependence = ParameterDependence((SPEED,), (ProductBasis((Polynomial(1),)),) * structure.size)
    theta = np.array([0.4, 0.1, 4.0, 1.0, 2.0, 0.1] if sample_time is None else [-1.2, 0.1, 0.7, 0.02, 2.0, 0.1])
    factor = np.random.default_rng(5).normal(size=(6, 6)) * 1e-3
    return Model(structure, dependence, theta, factor @ factor.T, 0.3)
