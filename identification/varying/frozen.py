"""An affine state-space model with its scheduling held still, as a model that is compared and diagnosed like others."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag

from identification.affine_estimate import AffineEstimate
from identification.affine_state_space import AffineStateSpace
from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.outcome import Outcome
from identification.places.linear import Coefficient
from identification.places.placed import PlacedEffect
from identification.scheduling import Numbers, ParameterDependence, ProductBasis
from identification.varying.affine_parameters import AffineSizes

ROUNDS, BALANCED = 60, 1e-13


@dataclass(frozen=True)
class FrozenStructure(RationalStructure):
    """G = C (zI − A)⁻¹ B + D with one input and output, ζ = (A, B, C, D) row by row: n_a = n_b = n_x, n_k = 0."""

    @classmethod
    def of(cls, order: int, sample_time: float) -> "FrozenStructure":
        """That of n_x states."""
        return cls(n_a=order, n_b=order, sample_time=sample_time)

    @property
    def n_plant(self) -> int:
        """(n_x + 1)²."""
        return (self.n_a + 1) ** 2

    @property
    def coefficient_names(self) -> tuple[str, ...]:
        """A(1,1) … D."""
        n = range(1, self.n_a + 1)
        return (*(f"A({i},{k})" for i in n for k in n), *(f"B({i})" for i in n), *(f"C({i})" for i in n), "D")

    def matrices(self, zeta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """A (…, n_x, n_x), B (…, n_x, 1), C (…, 1, n_x), D (…, 1, 1) of ζ (…, n)."""
        n = self.n_a
        a, b, c, d = np.split(zeta, [n * n, n * n + n, n * n + 2 * n], axis=-1)
        lead = zeta.shape[:-1]
        return a.reshape(*lead, n, n), b[..., :, None], c[..., None, :], d[..., None]

    def plant_response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """G(ω; ζ) for ζ (…, n) and ω (F,) in rad/s, as (…, F)."""
        state, _ = self._parts(zeta, omega)
        _, _, c, d = self.matrices(zeta)
        return np.asarray((c[..., None, :, :] @ state)[..., 0, 0] + d[..., 0])

    def plant_gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """∂G/∂ζ for ζ (…, n) and ω (F,), as (…, n, F): C R e_i e_kᵀ R B for A(i,k), with R = (zI − A)⁻¹."""
        state, through = self._parts(zeta, omega)
        left, right = through[..., 0, :], state[..., 0]
        by_a = (left[..., :, None] * right[..., None, :]).reshape(*left.shape[:-1], self.n_a**2)
        one = np.ones((*left.shape[:-1], 1), dtype=np.complex128)
        return np.asarray(np.swapaxes(np.concatenate([by_a, left, right, one], axis=-1), -1, -2))

    def poles(self, zeta: FloatArray) -> ComplexArray:
        """Eigenvalues of A."""
        return np.asarray(np.linalg.eigvals(self.matrices(zeta)[0]), dtype=np.complex128)

    def stable(self, zeta: FloatArray) -> BoolArray:
        """Whether they lie inside the unit circle."""
        return np.asarray(self.radius(zeta) < 1)

    def radius(self, zeta: FloatArray) -> FloatArray:
        """The largest modulus of a pole."""
        return np.asarray(abs(self.poles(zeta)).max(axis=-1))

    def _parts(self, zeta: FloatArray, omega: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """R B (…, F, n_x, 1) and C R (…, F, 1, n_x)."""
        a, b, c, _ = (part[..., None, :, :] for part in self.matrices(zeta))
        z = np.exp(1j * omega * (self.sample_time or 0.0))[:, None, None]
        resolvent = np.linalg.inv(z * np.eye(self.n_a) - a)
        return np.asarray(resolvent @ b), np.asarray(c @ resolvent)


@dataclass(frozen=True)
class ChartedDependence(ParameterDependence):
    """ζ(p) = T(p) Q δ: the entries of an affine model along a chart Q (size, free) of `AffineSizes`, flattened here."""

    chart: tuple[tuple[float, ...], ...] = ()

    @property
    def size(self) -> int:
        """That of δ."""
        return len(self.chart[0])

    @property
    def needed_operating_points(self) -> int:
        """One for the constant and one for each variable."""
        return len(self.variables) + 1

    def parameters_of(self, coefficients: int) -> int:
        """All of δ."""
        return self.size

    def coefficients(self, theta: FloatArray, points: ArrayLike) -> FloatArray:
        """T(p) Q δ."""
        return np.asarray(self.matrix(points) @ theta)

    def pulled(self, by_zeta: Numbers, points: ArrayLike) -> Numbers:
        """by_zeta T(p) Q."""
        spread = self.matrix(points)
        return np.asarray(by_zeta @ spread.reshape(len(spread), *(1,) * (by_zeta.ndim - 3), *spread.shape[1:]))

    def parameter_names(self, coefficient_names: object) -> tuple[str, ...]:
        """δ1, δ2, …"""
        return tuple(f"δ{i + 1}" for i in range(self.size))

    def matrix(self, points: ArrayLike) -> FloatArray:
        """T(p) Q at the operating points (M, s), as (M, n, free)."""
        p = self.points(points)
        weights = np.concatenate([np.ones((len(p), 1)), p], axis=1)
        chart = np.array(self.chart)
        n = int(np.sqrt(len(self.bases))) - 1
        m, parts, start = weights.shape[1], [], 0
        for rows in (n * n, n, n, 1):
            stack = chart[start : start + m * rows].reshape(m, rows, -1)
            parts.append(np.tensordot(weights, stack, axes=1))
            start += m * rows
        return np.asarray(np.concatenate(parts, axis=1))


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
    balanced = model.transformed(basis)
    sizes = AffineSizes.of(balanced)
    theta = sizes.join((balanced.a, balanced.b, balanced.c, balanced.d))
    chart = sizes.chart(theta)
    dependence = ChartedDependence(
        model.variables,
        (ProductBasis((Polynomial(0),) * len(model.variables)),) * (sizes.order + 1) ** 2,
        chart=tuple(tuple(map(float, row)) for row in chart),
    )
    inner = chart.T @ _turning(sizes, basis)
    known = estimate.covariance
    covariance = np.zeros((sizes.free, sizes.free)) if known is None else inner @ known @ inner.T
    base = Model(
        FrozenStructure.of(sizes.order, model.sample_time), dependence, chart.T @ theta, covariance, noise_variance=1.0
    )
    if not effects:
        return replace(base, joint_covariance=None if known is None else covariance)
    return replace(base, effects=effects, joint_covariance=None if joint is None else _on_both_sides(inner, joint))


def affine_estimate(model: Model) -> tuple[AffineEstimate, FloatArray | None]:
    """The affine model that `frozen` made this one of, as it is now, and the joint covariance of θ and the effects."""
    dependence, structure = model.dependence, model.structure
    assert isinstance(dependence, ChartedDependence), "made by `frozen`"
    chart = np.array(dependence.chart)
    sizes = AffineSizes(structure.n_a, len(dependence.variables), 1, 1)
    affine = sizes.model(chart @ model.theta, structure.sample_time or 0.0, dependence.variables)
    joint = None if model.joint_covariance is None else _on_both_sides(chart, model.joint_covariance)
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
