"""Standard deviations of poles, to first order in the covariance of the coefficients."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.models.model import LocalModel, Model


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
    values, gradient = model.structure.pole_gradient(model.coefficients(points))
    return _uncertain(values, model.pulled(gradient, points), model.plant_covariance)


def local_poles(model: LocalModel) -> UncertainPoles:
    """Of one local model, M = 1."""
    values, gradient = model.structure.pole_gradient(model.zeta[None])
    size = model.structure.n_plant
    return _uncertain(values, gradient, model.covariance[:size, :size])


def _uncertain(values: ComplexArray, sensitivity: ComplexArray, covariance: FloatArray) -> UncertainPoles:
    order = np.argsort(values, axis=-1)
    deviations = (
        np.take_along_axis(np.sqrt(np.einsum("mxi,ij,mxj->mx", part, covariance, part)), order, axis=-1)
        for part in (sensitivity.real, sensitivity.imag)
    )
    return UncertainPoles(np.take_along_axis(values, order, axis=-1), *deviations)
