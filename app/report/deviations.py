"""Standard deviations of poles, to first order in the covariance of the model."""

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.models import LpvModel


def poles_with_deviations(model: LpvModel, points: ArrayLike) -> tuple[ComplexArray, FloatArray, FloatArray]:
    """Poles (M, n_a) in the order of their real parts, and the deviations of real and imaginary parts.

    ∂x/∂a_i = −x^{n_a − i} / A′(x) at a zero x of A
    """
    structure = model.structure
    scale = 1.0 if structure.is_discrete else structure.frequency_scale
    zeros = np.sort_complex(model.poles(points) / scale)
    order = zeros.shape[-1]
    differences = zeros[..., :, None] - zeros[..., None, :] + np.eye(order)
    slope = -(zeros[..., None] ** np.arange(order - 1, -1, -1)) / differences.prod(axis=-1)[..., None]
    transfer = model.dependence.matrix(points)[:, :order]
    sensitivity = scale * np.einsum("mxa,mak->mxk", slope, transfer)
    real, imaginary = (
        np.sqrt(np.einsum("mxi,ij,mxj->mx", part, model.covariance, part))
        for part in (sensitivity.real, sensitivity.imag)
    )
    return scale * zeros, real, imaginary
