"""An affine state-space model as one of structure and dependence, compared and diagnosed like others."""

from dataclasses import replace

import numpy as np
from scipy.linalg import block_diag

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError
from identification.models.model import Model
from identification.models.state_space_model import charted, state_space_model
from identification.outcome import Outcome
from identification.places.linear import Coefficient
from identification.places.placed import PlacedEffect
from identification.scheduling import ProductBasis
from identification.varying.affine_estimate import AffineEstimate
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace

ROUNDS, BALANCED = 60, 1e-13


def smallest_basis(model: AffineStateSpace) -> FloatArray:
    """The change of state basis T (n_x, n_x), x = T x', after which the matrices are smallest in Frobenius norm.

        min_T ‖θ(T)‖²,   T ← T exp(E),   E = −½ arg min_E ‖θ + t(E)‖,   t(E) = (A_i E − E A_i, −E B_i, C_i E)

    There θ is perpendicular to every change of the basis, so that it lies in its own chart. E is symmetric; the second
    derivative of ‖θ‖² along exp(sE) is 4 ‖t(E)‖², so these are Newton's steps, halved until they lead down.
    """
    sizes, n = AffineSizes.of(model), model.order
    total = np.eye(n)
    for _ in range(ROUNDS):
        theta = sizes.join((model.a, model.b, model.c, model.d))
        tangents = sizes.similarity_tangent(theta)
        pairs = [(i, k) for i in range(n) for k in range(i, n)]
        units = np.array([_symmetric_unit(n, i, k) for i, k in pairs])
        columns = tangents @ units.reshape(len(pairs), -1).T
        weights = -0.5 * np.linalg.lstsq(columns, theta, rcond=None)[0]
        step = np.tensordot(weights, units, axes=1)
        if np.linalg.norm(step) < BALANCED:
            break
        model, basis = _stepped(model, step, float(np.linalg.norm(theta)))
        total = total @ basis
    return np.asarray(total)


def _stepped(model: AffineStateSpace, step: FloatArray, size: float) -> tuple[AffineStateSpace, FloatArray]:
    """The model after exp(E), E halved until ‖θ‖ has not grown; rounding ends the halving."""
    sizes = AffineSizes.of(model)
    for _ in range(30):
        values, vectors = np.linalg.eigh(step)
        basis = np.asarray((vectors * np.exp(np.clip(values, -30, 30))) @ vectors.T)
        trial = model.transformed(basis)
        if np.linalg.norm(sizes.join((trial.a, trial.b, trial.c, trial.d))) <= size * (1 + 1e-14):
            return trial, basis
        step = step / 2
    return model, np.eye(model.order)


def _symmetric_unit(n: int, i: int, k: int) -> FloatArray:
    unit = np.zeros((n, n))
    unit[i, k] = unit[k, i] = 1.0
    return unit


def frozen(estimate: AffineEstimate, effects: tuple[PlacedEffect, ...] = (), joint: FloatArray | None = None) -> Model:
    """The model of an estimate with one input and output, its scheduling held still, its parameters δ, θ = Q δ.

    `joint`: the covariance of θ and the parameters of the `effects` together, None when it is not known. Raises
    MisuseError for several inputs or outputs, without declared scheduling variables, or for effects on coefficients,
    which mean something else in every state basis.
    """
    if any(isinstance(one.effect, Coefficient) for one in effects):
        raise MisuseError("effects on the coefficients of a state-space model depend on its state basis", "effects")
    model = estimate.model
    if model.n_inputs != 1 or model.n_outputs != 1 or not model.variables:
        raise MisuseError(
            f"the model has {model.n_inputs} inputs and {model.n_outputs} outputs; only models with one of each are"
            " held against experiments at operating points that are held still",
            "model",
        )
    basis = smallest_basis(model)
    turning = _turning(AffineSizes.of(model), basis)
    known = None if estimate.covariance is None else turning @ estimate.covariance @ turning.T
    found = charted(affine_model(AffineEstimate(model.transformed(basis), estimate.outcome, (), known)))
    assert found.chart is not None, "state spaces have a chart"
    if effects:
        inner = found.chart.T @ turning[AffineSizes.of(model).in_products]
        both = None if joint is None else _on_both_sides(inner, joint)
    else:
        both = None if estimate.covariance is None else found.plant_covariance
    return replace(found, effects=effects, joint_covariance=both)


def affine_model(estimate: AffineEstimate) -> Model:
    """The model of an estimate with declared scheduling variables, its matrices over 1 and each variable."""
    affine, places = estimate.model, AffineSizes.of(estimate.model).in_products
    functions = [0, *range(affine.n_scheduling, 0, -1)]
    a, b, c, d = (part[functions] for part in (affine.a, affine.b, affine.c, affine.d))
    basis = ProductBasis((Polynomial(1),) * affine.n_scheduling, total_degree=1)
    known = None if estimate.covariance is None else estimate.covariance[np.ix_(places, places)]
    return state_space_model(affine.variables, (basis,) * 4, (a, b, c, d), affine.sample_time, known)


def affine_estimate(model: Model) -> tuple[AffineEstimate, FloatArray | None]:
    """The affine model that `frozen` made this one of, as it is now, and the joint covariance of θ and the effects."""
    assert model.chart is not None, "made by `frozen`"
    sizes = AffineSizes.like(model)
    back = np.argsort(sizes.in_products)
    affine = sizes.model(model.theta[back], model.structure.sample_time or 0.0, model.variables)
    joint = None if model.joint_covariance is None else _on_both_sides(model.chart[back], model.joint_covariance)
    covariance = None if joint is None else joint[: sizes.size, : sizes.size]
    return AffineEstimate(affine, Outcome("converged"), (), covariance), joint


def _on_both_sides(matrix: FloatArray, joint: FloatArray) -> FloatArray:
    """diag(M, I) P diag(M, I)ᵀ."""
    beside = np.eye(len(joint) - matrix.shape[1])
    whole = block_diag(matrix, beside)
    return np.asarray(whole @ joint @ whole.T)


def _turning(sizes: AffineSizes, basis: FloatArray) -> FloatArray:
    """∂θ'/∂θ (size, size) for a fixed change of the state basis T."""
    inverse = np.linalg.inv(basis).astype(np.float64)
    columns = []
    for unit in np.eye(sizes.size):
        a, b, c, d = sizes.split(unit)
        columns.append(sizes.join((inverse @ a @ basis, inverse @ b, c @ basis, d)))
    return np.stack(columns, axis=1)
