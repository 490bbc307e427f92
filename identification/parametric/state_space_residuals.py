"""Residuals of a parametric state-space model on frequency responses, and their exact derivatives."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.parameter_varying import ParameterVaryingStateSpace
from identification.signals import FrequencyResponse


@dataclass(frozen=True, eq=False)
class StateSpaceParameters:
    """All entries of A_j, B_j, C_j, D_j of a model as one vector θ, in this order, each matrix row by row."""

    like: ParameterVaryingStateSpace

    @cached_property
    def _shapes(self) -> tuple[tuple[int, ...], ...]:
        return tuple(m.shape for m in (self.like.a, self.like.b, self.like.c, self.like.d))

    def vector(self, model: ParameterVaryingStateSpace) -> FloatArray:
        """θ (k,) of a model."""
        return np.concatenate([m.ravel() for m in (model.a, model.b, model.c, model.d)])

    def model(self, theta: FloatArray) -> ParameterVaryingStateSpace:
        """The model with θ (k,)."""
        ends = np.cumsum([np.prod(shape) for shape in self._shapes])[:-1]
        parts = np.split(theta, ends.astype(int))
        a, b, c, d = (part.reshape(shape) for part, shape in zip(parts, self._shapes, strict=True))
        return ParameterVaryingStateSpace(self.like.variables, self.like.bases, a, b, c, d, self.like.sample_time)

    def directions_without_effect(self, model: ParameterVaryingStateSpace) -> FloatArray:
        """The n² directions of θ in which only the state basis changes, (k, n²) [McKelvey2004].

        A_j → A_j E − E A_j,   B_j → −E B_j,   C_j → C_j E,   for every E (n, n)
        """
        n = model.order
        units = np.eye(n * n).reshape(n * n, 1, n, n)
        zeros = np.zeros((n * n, model.d.size))
        parts = [model.a @ units - units @ model.a, -units @ model.b, model.c @ units]
        return np.concatenate([*(part.reshape(n * n, -1) for part in parts), zeros], axis=1).T

    def gradient(self, model: ParameterVaryingStateSpace, point: Sequence[float], omega: FloatArray) -> ComplexArray:
        """∂ vec G/∂θ at one operating point and ω (F,), as (F, n_y n_u, k), entries of G row by row.

        ∂G/∂A_j = f_j(p) [C (zI − A)⁻¹]ᵀ [(zI − A)⁻¹ B]ᵀ and so on: no differences
        """
        system = model.at([point])
        left, right = system.adjoint_states(omega)[0], system.states(omega)[0]
        n_y, n_u, lines = model.output_count, model.input_count, len(omega)
        values = [b.evaluate(np.array([point], dtype=float), model.variables)[0] for b in model.dependence.bases]
        to_a = np.einsum("j,fya,fbu->fyujab", values[0], left, right)
        to_b = np.einsum("j,fya,uv->fyujav", values[1], left, np.eye(n_u))
        to_c = np.einsum("j,yx,fbu->fyujxb", values[2], np.eye(n_y), right)
        to_d = np.einsum("j,yx,uv->yujxv", values[3], np.eye(n_y), np.eye(n_u))
        to_d = np.broadcast_to(to_d, (lines, *to_d.shape))
        parts = [part.reshape(lines, n_y * n_u, -1) for part in (to_a, to_b, to_c, to_d)]
        return np.concatenate(parts, axis=2, dtype=np.complex128)


def whitener(data: FrequencyResponse) -> ComplexArray:
    """W (F, n_y n_u, n_y n_u) or (F, n_y n_u, 1) with W n of unit covariance; ones when the data state no variance."""
    size = data.matrices[0].size
    if data.covariance is not None:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(data.covariance)))
    if data.variance is None:
        return np.ones((len(data), size, 1), dtype=np.complex128)
    return np.asarray(data.variance.reshape(len(data), size, 1) ** -0.5, dtype=np.complex128)


def residual_and_jacobian(
    parameters: StateSpaceParameters,
    theta: FloatArray,
    experiments: Sequence[FrequencyResponse],
    whiteners: Sequence[ComplexArray],
) -> tuple[FloatArray, FloatArray]:
    """r = √2 (Re, Im) W vec(Ĝ − G(θ)) over all lines and operating points (R,), and ∂r/∂θ (R, k)."""
    model = parameters.model(theta)
    errors, gradients = [], []
    for data, weight in zip(experiments, whiteners, strict=True):
        response = model.frequency_response([data.operating_point], data.frequencies)[0]
        error = (data.matrices - response).reshape(len(data), -1, 1)
        gradient = -parameters.gradient(model, data.operating_point, data.frequencies)
        errors.append(_weighted(weight, error).ravel())
        gradients.append(_weighted(weight, gradient).reshape(-1, gradient.shape[2]))
    error, gradient = np.sqrt(2) * np.concatenate(errors), np.sqrt(2) * np.concatenate(gradients)
    return np.concatenate([error.real, error.imag]), np.concatenate([gradient.real, gradient.imag])


def _weighted(weight: ComplexArray, values: ComplexArray) -> ComplexArray:
    return np.asarray(weight * values if weight.shape[2] == 1 else weight @ values)
