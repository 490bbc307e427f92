"""State-space models over the scheduling variables, written by their matrices."""

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from scipy.linalg import block_diag

from identification.arrays import FloatArray, finite_floats
from identification.errors import MisuseError, ShapeError
from identification.models.chart import gauge_tangent, perpendicular
from identification.models.model import Model
from identification.models.state_space import Matrices, StateSpaceStructure
from identification.models.system import require_matching
from identification.places.linear import Coefficient
from identification.places.placed import PlacedEffect
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

    θ are the entries of A_1, A_2, …, B_1, …, each matrix row by row; `covariance` of θ, None when it is not known.
    What changes only the state basis has no covariance: the chart of a model with one leaves it out. Raises ShapeError
    for sizes that do not fit, and RangeError for values that are not finite.
    """
    matrices = _checked(matrices, bases)
    a, b, c, _ = matrices
    structure = StateSpaceStructure(a.shape[-1], b.shape[-1], c.shape[-2], sample_time)
    dependence = structure.over(variables, **dict(zip("ABCD", bases, strict=True)))
    theta = np.concatenate([np.ravel(part) for part in matrices])
    model = Model(structure, dependence, theta, covariance, noise_variance)
    return model if covariance is None else charted(model)


def functions_along(model: Model, scheduling: FloatArray) -> FloatArray:
    """ψ (N, k) along p (N, s) of a model whose matrices are all over the same functions, stored signal by signal."""
    basis = model.dependence.bases[0]
    return np.asfortranarray(basis.evaluate(model.dependence.points(scheduling), model.variables))


def charted(model: Model) -> Model:
    """The model, moving only in directions that a response shows."""
    return replace(model, chart=perpendicular(gauge_tangent(model.structure, model.dependence, model.theta)))


def carrying(model: Model, effects: tuple[PlacedEffect, ...], joint: FloatArray | None) -> Model:
    """The model with effects in it; `joint`: the covariance of θ and their parameters, as `joint_of_entries` gives.

    Raises MisuseError for several inputs or outputs, or for effects on coefficients, which mean something else in every
    state basis.
    """
    shape = model.structure.inputs, model.structure.outputs
    if shape != (1, 1):
        raise MisuseError(
            f"the model has {shape[0]} inputs and {shape[1]} outputs; only models with one of each are held against"
            " experiments at operating points that are held still",
            "model",
        )
    if any(isinstance(one.effect, Coefficient) for one in effects):
        raise MisuseError("effects on the coefficients of a state-space model depend on its state basis", "effects")
    found = charted(model)
    if not effects:
        return found
    assert found.chart is not None, "state spaces have one"
    both = None if joint is None else _on_both_sides(found.chart.T, joint)
    return replace(found, effects=effects, joint_covariance=both)


def joint_of_entries(model: Model) -> FloatArray | None:
    """The covariance of θ and the parameters of the effects together, which were estimated along the chart."""
    if model.joint_covariance is None or model.chart is None:
        return model.joint_covariance
    return _on_both_sides(model.chart, model.joint_covariance)


def _on_both_sides(matrix: FloatArray, joint: FloatArray) -> FloatArray:
    """diag(M, I) P diag(M, I)ᵀ."""
    whole = block_diag(matrix, np.eye(len(joint) - matrix.shape[1]))
    return np.asarray(whole @ joint @ whole.T)


def _checked(matrices: Matrices, bases: Sequence[ProductBasis]) -> Matrices:
    if len(bases) != 4:
        raise ShapeError(f"{len(bases)} bases were given; give one each for A, B, C and D", "bases")
    a, b, c, d = (finite_floats(part, name) for part, name in zip(matrices, "abcd", strict=True))
    for name, part, basis in zip("abcd", (a, b, c, d), bases, strict=True):
        if part.ndim != 3 or len(part) != basis.size:
            raise ShapeError(
                f"{name.upper()} has shape {part.shape}; give {basis.size} matrices, one per function", name
            )
    require_matching(a[0], b[0], c[0], d[0])
    return a, b, c, d


def stacks(model: Model) -> Matrices:
    """A_j, B_j, C_j, D_j of such a model, each (functions, ·, ·)."""
    shapes = cast(StateSpaceStructure, model.structure).shapes
    parts = zip(model.dependence.split(model.theta), shapes, strict=True)
    a, b, c, d = (part.reshape(-1, *shape) for part, shape in parts)
    return a, b, c, d
