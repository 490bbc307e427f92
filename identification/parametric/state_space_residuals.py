"""Residuals of a parametric state-space model on frequency responses, and their exact derivatives."""

from collections.abc import Sequence

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.models.model import Model
from identification.signals import FrequencyResponse


def entry_gradient(model: Model, point: Sequence[float], omega: FloatArray) -> ComplexArray:
    """∂ vec G/∂θ at one operating point and ω (F,), as (F, n_y n_u, k), entries of G row by row."""
    gradient = model.structure.gradient(model.coefficients([point]), omega)
    return np.reshape(model.dependence.pulled(gradient, [point]), (len(omega), -1, len(model.theta)))


def whitener(data: FrequencyResponse) -> ComplexArray:
    """W (F, n_y n_u, n_y n_u) or (F, n_y n_u, 1) with W n of unit covariance; ones when the data state no variance."""
    size = data.matrices[0].size
    if data.covariance is not None:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(data.covariance)))
    if data.variance is None:
        return np.ones((len(data), size, 1), dtype=np.complex128)
    return np.asarray(data.variance.reshape(len(data), size, 1) ** -0.5, dtype=np.complex128)


def residual_and_jacobian(
    model: Model, experiments: Sequence[FrequencyResponse], whiteners: Sequence[ComplexArray]
) -> tuple[FloatArray, FloatArray]:
    """r = √2 (Re, Im) W vec(Ĝ − G(θ)) over all lines and operating points (R,), and ∂r/∂θ (R, k)."""
    errors, gradients = [], []
    for data, weight in zip(experiments, whiteners, strict=True):
        response = model.frequency_response([data.operating_point], data.frequencies)[0]
        error = (data.matrices - response).reshape(len(data), -1, 1)
        gradient = -entry_gradient(model, data.operating_point, data.frequencies)
        errors.append(_weighted(weight, error).ravel())
        gradients.append(_weighted(weight, gradient).reshape(-1, gradient.shape[2]))
    error, gradient = np.sqrt(2) * np.concatenate(errors), np.sqrt(2) * np.concatenate(gradients)
    return np.concatenate([error.real, error.imag]), np.concatenate([gradient.real, gradient.imag])


def whitened_error(
    model: Model, experiments: Sequence[FrequencyResponse], whiteners: Sequence[ComplexArray]
) -> FloatArray:
    """r of `residual_and_jacobian` alone."""
    errors = []
    for data, weight in zip(experiments, whiteners, strict=True):
        response = model.frequency_response([data.operating_point], data.frequencies)[0]
        errors.append(_weighted(weight, (data.matrices - response).reshape(len(data), -1, 1)).ravel())
    error = np.sqrt(2) * np.concatenate(errors)
    return np.concatenate([error.real, error.imag])


def _weighted(weight: ComplexArray, values: ComplexArray) -> ComplexArray:
    return np.asarray(weight * values if weight.shape[2] == 1 else weight @ values)
