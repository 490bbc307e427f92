"""How much an experiment tells about θ, per unit of input energy and per sample."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.models import LpvModel

LARGEST_GRID = 2**17


def sensitivity(model: LpvModel, points: ArrayLike, omega: FloatArray) -> ComplexArray:
    """a(p, ω) = T_G(p)ᵀ F_u(p, e^{jω}) / σ_e,  F_u = H⁻¹ ∂G/∂ζ_G, for points (M, s) and ω (F,) rad/s, as (M, F, k_G).

    Re(a a*) is the information about θ_G that one unit of input energy Σ_t u(t)² gives [Ghosh2018, (7), (14)].
    """
    transfer = model.dependence.matrix(points)
    zeta = transfer @ model.theta
    weighted = model.structure.plant_gradient(zeta, omega) / model.structure.noise_response(zeta, omega)[:, None, :]
    plant_part = transfer[:, : model.structure.n_plant, : model.plant_size]
    return np.asarray(np.swapaxes(weighted, 1, 2) @ plant_part / np.sqrt(model.noise_variance))


def noise_information(model: LpvModel, points: ArrayLike) -> FloatArray:
    """X^H(p) = T_Hᵀ (1/2π ∫ F_e F_e* dω) T_H, F_e = H⁻¹ ∂H/∂ζ_H, at points (M, s), as (M, k_H, k_H).

    [Ghosh2018, (8), (18)] The information about θ_H that each sample of a record gives, whatever the input.
    """
    transfer = model.dependence.matrix(points)[:, model.structure.n_plant :, model.plant_size :]
    if transfer.size == 0:
        return np.zeros((len(transfer), transfer.shape[2], transfer.shape[2]))
    zeta = model.coefficients(points)

    def products(omega: FloatArray) -> FloatArray:
        weighted = model.structure.noise_gradient(zeta, omega) / model.structure.noise_response(zeta, omega)[:, None, :]
        return np.asarray(np.einsum("mif,mjf->mijf", weighted, weighted.conj()).real)

    mean = _cosine_moments(products, model.structure.sample_time or 1.0, 0)[..., 0]
    return np.asarray(np.swapaxes(transfer, 1, 2) @ mean @ transfer)


def sensitivity_moments(model: LpvModel, points: ArrayLike, degree: int, sample_time: float) -> FloatArray:
    """(1/2π) ∫ Re(a a*) cos(iΩ) dΩ, Ω = ω · sample_time in (−π, π), i = 0 … degree, as (M, k_G, k_G, degree + 1)."""

    def products(omega: FloatArray) -> FloatArray:
        a = sensitivity(model, points, omega)
        return np.asarray(np.einsum("mfi,mfj->mijf", a, a.conj(), optimize=True).real)

    return _cosine_moments(products, sample_time, degree)


def _cosine_moments(products: Callable[[FloatArray], FloatArray], sample_time: float, degree: int) -> FloatArray:
    """Fourier cosine coefficients of an even function of ω, by the trapezoidal rule, refined until they settle."""
    half, previous = max(128, 2 ** int(np.ceil(np.log2(degree + 1)) + 1)), None
    while half <= LARGEST_GRID:
        values = products(np.linspace(0.0, np.pi / sample_time, half + 1))
        moments = np.fft.irfft(values, 2 * half, axis=-1)[..., : degree + 1]
        if previous is not None and np.max(abs(moments - previous)) <= 1e-11 * np.max(abs(moments)):
            return np.asarray(moments)
        half, previous = 2 * half, moments
    raise MisuseError(
        "a pole or zero of the model lies so close to the unit circle that its information cannot be integrated; use"
        " line spectra or exclude the operating points concerned",
        "points",
    )


def require_stable(model: LpvModel, points: ArrayLike) -> None:
    """Raises MisuseError when the model, or the inverse of its noise model, is unstable at one of the points."""
    p = model.dependence.points(points)
    stable = model.structure.stable(model.coefficients(p))
    if model.structure.is_discrete and not stable.all():
        where = ", ".join(f"{value:g}" for value in p[~stable][0])
        raise MisuseError(
            f"the model is unstable at the operating point ({where}); exclude the point or correct the model", "points"
        )
