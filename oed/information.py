"""How much an experiment tells about θ, per unit of input energy and per sample."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.models.model import Model

LARGEST_GRID = 2**18
CONTINUOUS_GRID = 2**14
PRODUCTS_AT_ONCE = 2**23


def sensitivity(model: Model, points: ArrayLike, omega: FloatArray) -> ComplexArray:
    """a(p, ω) = T_G(p)ᵀ F_u(p, e^{jω}) / σ_e,  F_u = H⁻¹ ∂G/∂ζ_G, for points (M, s) and ω (F,) rad/s, as (M, F, k_G).

    Re(a a*) is the information about θ_G that one unit of input energy Σ_t u(t)² gives [Ghosh2018, (7), (14)].
    """
    zeta = model.coefficients(points)
    noise = np.sqrt(model.noise_variance) * model.structure.noise_response(zeta, omega)
    weighted = model.structure.plant_gradient(zeta, omega) / noise[:, None, :]
    return model.pulled(np.swapaxes(weighted, 1, 2), points)


def noise_information(model: Model, points: ArrayLike) -> FloatArray:
    """X^H(p) = T_Hᵀ (1/2π ∫ F_e F_e* dω) T_H, F_e = H⁻¹ ∂H/∂ζ_H, at points (M, s), as (M, k_H, k_H).

    [Ghosh2018, (8), (18)] The information about θ_H that each sample of a record gives, whatever the input.
    """
    transfer = model.dependence.matrix(points)[:, model.structure.n_plant :, model.plant_size :]
    if transfer.size == 0:
        return np.zeros((len(transfer), transfer.shape[2], transfer.shape[2]))
    zeta = model.coefficients(points)
    grid = circle(model, points, 0, 1.0 if model.structure.sample_time is None else model.structure.sample_time)
    weighted = model.structure.noise_gradient(zeta, grid) / model.structure.noise_response(zeta, grid)[:, None, :]
    mean = cosine_moments(np.swapaxes(weighted, 1, 2), 0)[:, 0]
    return np.asarray(np.swapaxes(transfer, 1, 2) @ mean @ transfer)


def sensitivity_moments(model: Model, points: ArrayLike, degree: int, sample_time: float) -> FloatArray:
    """(1/2π) ∫ Re(a a*) cos(iΩ) dΩ, Ω = ω · sample_time in (−π, π), i = 0 … degree, as (M, degree + 1, k_G, k_G)."""
    p, grid = model.dependence.points(points), circle(model, points, degree, sample_time)
    at_once = max(1, PRODUCTS_AT_ONCE // (len(grid) * model.plant_size**2))
    parts = (p[start : start + at_once] for start in range(0, len(p), at_once))
    return np.concatenate([cosine_moments(sensitivity(model, part, grid), degree) for part in parts])


def circle(model: Model, points: ArrayLike, degree: int, sample_time: float) -> FloatArray:
    """Frequencies from 0 to Nyquist on which the trapezoidal rule is exact to rounding in discrete time.

    A rational function with poles of radius ρ < 1 has moments that fall as ρ^i, and the rule on N points folds the
    moment N − i onto the i-th. Continuous-time responses are not rational in e^{jΩ}; a fixed fine grid serves.
    """
    if model.structure.is_discrete:
        radius = float(model.structure.radius(model.coefficients(points)).max(initial=0.1))
        count = degree + np.log(1e-14) / np.log(min(max(radius, 0.1), 1 - 1e-9))
    else:
        count = max(CONTINUOUS_GRID, 8 * degree)
    if count > LARGEST_GRID:
        raise MisuseError(
            "a pole of the model lies so close to the unit circle that its information cannot be integrated; use line"
            " spectra or exclude the operating points concerned",
            "points",
        )
    return np.linspace(0.0, np.pi / sample_time, fft.next_fast_len(int(count / 2) + 8, real=True) + 1)


def cosine_moments(rows: ComplexArray, degree: int) -> FloatArray:
    """Fourier cosine coefficients 0 … degree of Re(a a*) for a (M, F, k) on a grid from 0 to Nyquist, (M, ·, k, k)."""
    upper = np.triu_indices(rows.shape[-1])
    columns = np.swapaxes(rows, 1, 2)
    real, imag = columns.real.copy(), columns.imag.copy()
    products = real[:, upper[0]] * real[:, upper[1]] + imag[:, upper[0]] * imag[:, upper[1]]
    moments = np.swapaxes(fft.irfft(products, 2 * (rows.shape[1] - 1))[..., : degree + 1], 1, 2)
    full = np.empty((*moments.shape[:2], rows.shape[-1], rows.shape[-1]))
    full[..., upper[0], upper[1]] = full[..., upper[1], upper[0]] = moments
    return full


def require_stable(model: Model, points: ArrayLike) -> None:
    """Raises MisuseError when the model, or the inverse of its noise model, is unstable at one of the points."""
    p = model.dependence.points(points)
    stable = model.structure.stable(model.coefficients(p))
    if model.structure.is_discrete and not stable.all():
        where = ", ".join(f"{value:g}" for value in p[~stable][0])
        raise MisuseError(
            f"the model is unstable at the operating point ({where}); exclude the point or correct the model", "points"
        )
