"""Random stable parameter-varying models."""

import numpy as np

from identification.bases.chebyshev import Chebyshev
from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable


def paper_model(theta: tuple[float, ...] = (-0.9, 0.1, 10.0, -1.0, -0.7, 0.08), noise_variance: float = 0.5) -> Model:
    """The example of Ghosh 2018, Section 5."""
    structure = RationalStructure(1, 0, 1, 0, 1, sample_time=1.0)
    linear = ProductBasis((Polynomial(1),))
    dependence = ParameterDependence((SchedulingVariable("p", "1", 0.0, 8.0),), (linear,) * 3)
    return Model(structure, dependence, np.array(theta), np.zeros((6, 6)), noise_variance)


def random_model(rng: np.random.Generator) -> Model:
    """Orders, bases and parameters drawn at random; stable, with a stable noise model, over the whole range."""
    structure = RationalStructure(
        n_a=int(rng.integers(1, 3)),
        n_b=int(rng.integers(0, 2)),
        n_k=int(rng.integers(0, 2)),
        n_c=int(rng.integers(0, 2)),
        n_d=int(rng.integers(0, 2)),
        sample_time=float(rng.choice([1.0, 0.01])),
    )
    variable = SchedulingVariable("speed", "rad/s", -1.0, 3.0)
    bases = tuple(_random_basis(rng) for _ in range(structure.size))
    dependence = ParameterDependence((variable,), bases)
    grid = np.linspace(variable.minimum, variable.maximum, 41)[:, None]
    while True:
        theta = rng.normal(size=dependence.size) * 0.35
        model = Model(structure, dependence, theta, np.zeros((len(theta),) * 2), float(rng.uniform(0.1, 2.0)))
        if np.all(structure.radius(model.coefficients(grid)) < 0.95):
            return model


def _random_basis(rng: np.random.Generator) -> ProductBasis:
    family = Polynomial if rng.random() < 0.5 else Chebyshev
    return ProductBasis((family(int(rng.integers(0, 3))),))
