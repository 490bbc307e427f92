"""State-space models over the scheduling variables, written by their matrices."""

from collections.abc import Sequence
from typing import cast

import numpy as np

from identification.arrays import FloatArray
from identification.models.chart import gauge_tangent, perpendicular
from identification.models.model import Model
from identification.models.state_space import Matrices, StateSpaceStructure
from identification.scheduling import ProductBasis, SchedulingVariable


def state_space_model(
    variables: tuple[SchedulingVariable, ...],
    bases: Sequence[ProductBasis],
    matrices: Matrices,
    sample_time: float | None,
    covariance: FloatArray | None = None,
    noise_variance: float = 1.0,
) -> Model:
    """A(p) = Σ_j A_j f_j(p), and B, C, D alike, for stacks (functions, ·, ·) of the four matrices.

    θ are the entries of A_1, A_2, …, B_1, …, each matrix row by row; `covariance` of θ, zero when it is exactly known.
    What changes only the state basis has no covariance: the chart of the model leaves it out.
    """
    a, b, c, _ = matrices
    structure = StateSpaceStructure(a.shape[-1], b.shape[-1], c.shape[-2], sample_time)
    dependence = structure.over(variables, **dict(zip("ABCD", bases, strict=True)))
    theta = np.concatenate([np.ravel(part) for part in matrices])
    known = np.zeros((len(theta),) * 2) if covariance is None else covariance
    chart = perpendicular(gauge_tangent(structure, dependence, theta))
    return Model(structure, dependence, theta, known, noise_variance, chart=chart)


def stacks(model: Model) -> Matrices:
    """A_j, B_j, C_j, D_j of such a model, each (functions, ·, ·)."""
    shapes = cast(StateSpaceStructure, model.structure).shapes
    parts = zip(model.dependence.split(model.theta), shapes, strict=True)
    a, b, c, d = (part.reshape(-1, *shape) for part, shape in parts)
    return a, b, c, d
