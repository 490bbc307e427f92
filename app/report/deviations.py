"""Standard deviations of poles, to first order in the covariance of the coefficients."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.models.model import LocalModel, Model
from identification.models.rational import RationalStructure


@dataclass(frozen=True, eq=False)
class UncertainPoles:
    """Poles (M, n_a) in the order of their real parts, with the deviations of real and imaginary parts."""

    values: ComplexArray
    real_deviation: FloatArray
    imaginary_deviation: FloatArray

    def part(self, which: int) -> tuple[FloatArray, FloatArray]:
        """Real (0) or imaginary (1) parts and their deviations."""
        if which == 0:
            return self.values.real, self.real_deviation
        return self.values.imag, self.imaginary_deviation


def poles_of(model: Model, points: ArrayLike) -> UncertainPoles:
    """Along operating points (M, s)."""
    values, sensitivity = _sensitivity(model.structure, model.coefficients(points))
    by_theta = model.dependence.pulled(sensitivity, points)
    return _uncertain(values, by_theta, model.covariance[: by_theta.shape[-1], : by_theta.shape[-1]])


def local_poles(model: LocalModel) -> UncertainPoles:
    """Of one local model, M = 1."""
    values, sensitivity = _sensitivity(model.structure, model.zeta[None])
    order = model.structure.n_a
    return _uncertain(values, sensitivity, model.covariance[:order, :order])


def _sensitivity(structure: RationalStructure, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Zeros x (M, n_a) of A and ∂x/∂a_i = −x^{n_a − i} / A′(x) as (M, n_a, n_a), both in the unit of poles."""
    scale = 1.0 if structure.is_discrete else structure.frequency_scale
    zeros = np.sort_complex(structure.poles(zeta)) / scale
    order = structure.n_a
    differences = zeros[..., :, None] - zeros[..., None, :] + np.eye(order)
    powers = zeros[..., None] ** np.arange(order - 1, -1, -1)
    return np.asarray(scale * zeros), np.asarray(-scale * powers / differences.prod(axis=-1)[..., None])


def _uncertain(values: ComplexArray, sensitivity: ComplexArray, covariance: FloatArray) -> UncertainPoles:
    deviations = (
        np.sqrt(np.einsum("mxi,ij,mxj->mx", part, covariance, part)) for part in (sensitivity.real, sensitivity.imag)
    )
    return UncertainPoles(values, *deviations)
