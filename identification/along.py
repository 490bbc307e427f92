"""Parameter-varying models simulated along p(t), with the standard deviation of the output."""

from dataclasses import dataclass

import numpy as np

from identification.affine_estimate import AffineEstimate
from identification.affine_state_space import propagate
from identification.arrays import FloatArray
from identification.confidence import covariance_root
from identification.errors import MisuseError, RangeError
from identification.models.model import Model
from identification.parameter_varying import ParameterVaryingStateSpace
from identification.scheduling import ParameterDependence

SAMPLES_AT_ONCE = 20_000
UNSTABLE = "the simulated output grows beyond all numbers: the model is unstable along this scheduling"


@dataclass(frozen=True, eq=False)
class Simulation:
    """The output (N, n_y) from rest, and its standard deviation (N, n_y) by the covariance of the model, or None."""

    output: FloatArray
    deviation: FloatArray | None


def simulate_affine(estimate: AffineEstimate, input: FloatArray, scheduling: FloatArray) -> Simulation:
    """An affine state-space model for u (N, n_u) along p (N, n_p); raises ShapeError and RangeError."""
    output = estimate.model.simulate(input, scheduling)
    if estimate.covariance is None:
        return Simulation(output, None)
    covariance = estimate.output_covariance(input, scheduling)
    return Simulation(output, np.sqrt(np.maximum(np.einsum("tyy->ty", covariance), 0.0)))


def simulate_rational(
    model: Model, input: FloatArray, scheduling: FloatArray, covariance_known: bool = True
) -> Simulation:
    """A rational model in discrete time without delay, its coefficients following p (N, s) at once, for u (N,).

        y(t) = −Σ_i a_i(p(t)) y(t−i) + Σ_i b_i(p(t)) u(t−n_k−i),   y(t) = φ(t)ᵀ ζ_G(p(t))
        ∂y/∂θ_j(t) = −Σ_i a_i(p(t)) ∂y/∂θ_j(t−i) + φ(t)ᵀ T(p(t))_j

    Identified at frozen operating points, the model says nothing of what fast changes of p do; this is the plant that
    they have no effect of their own on. Raises MisuseError for continuous time or a delay, RangeError for p outside
    its range or an output that grows beyond all numbers.
    """
    structure = model.structure
    if not structure.is_discrete or structure.delay:
        raise MisuseError("only models in discrete time without an estimated delay are simulated along p(t)", "model")
    n_a, n = structure.n_a, structure.n_plant
    zeta = _along(model.dependence, model.theta, scheduling)[:, :n]
    delayed = np.stack([_delayed(input, structure.n_k + i) for i in range(n - n_a)], axis=1)
    forcing = np.sum(zeta[:, n_a:] * delayed, axis=1)
    transition = _companion(zeta[:, :n_a])
    y = _filtered(transition, forcing)
    if not np.all(np.isfinite(y)):
        raise RangeError(UNSTABLE, "scheduling")
    if not covariance_known:
        return Simulation(y[:, None], None)
    phi = np.concatenate([*(-_delayed(y, i + 1)[:, None] for i in range(n_a)), delayed], axis=1)
    variance = np.zeros(len(y))
    for direction in covariance_root(model.covariance[: model.plant_size, : model.plant_size]).T:
        change = np.zeros(len(model.theta))
        change[: model.plant_size] = direction
        moved = _along(model.dependence, change, scheduling)[:, :n]
        variance += _filtered(transition, np.sum(phi * moved, axis=1)) ** 2
    return Simulation(y[:, None], np.sqrt(variance)[:, None])


def simulate_state_space(model: ParameterVaryingStateSpace, input: FloatArray, scheduling: FloatArray) -> Simulation:
    """A state-space model in discrete time, its matrices following p (N, s) at once, for u (N, n_u); no deviation."""
    if model.sample_time is None:
        raise MisuseError("only models in discrete time are simulated along p(t)", "model")
    at = model.at(scheduling)
    forcing = (at.b @ input[:, :, None])[..., 0]
    with np.errstate(over="ignore", invalid="ignore"):
        x = propagate(at.a, forcing, np.zeros(model.order))[:-1]
        y = (at.c @ x[..., None] + at.d @ input[:, :, None])[..., 0]
    if not np.all(np.isfinite(y)):
        raise RangeError(UNSTABLE, "scheduling")
    return Simulation(y, None)


def _along(dependence: ParameterDependence, theta: FloatArray, scheduling: FloatArray) -> FloatArray:
    """T(p(t)) θ (N, n), a part of the samples at a time."""
    cuts = range(0, len(scheduling), SAMPLES_AT_ONCE)
    return np.concatenate([dependence.coefficients(theta, scheduling[k : k + SAMPLES_AT_ONCE]) for k in cuts])


def _delayed(signal: FloatArray, lag: int) -> FloatArray:
    lag = min(lag, len(signal))
    return np.concatenate([np.zeros(lag), signal[: len(signal) - lag]])


def _companion(a: FloatArray) -> FloatArray:
    """F(t) (N, n, n) of x(t+1) = F(t) x(t) + e_1 w(t), x(t) = (y(t−1), …, y(t−n))."""
    count, n = a.shape
    found = np.zeros((count, n, n))
    if n:
        found[:, 0] = -a
        found[:, np.arange(1, n), np.arange(n - 1)] = 1.0
    return found


def _filtered(transition: FloatArray, forcing: FloatArray) -> FloatArray:
    """y (N,) with y(t) = first entry of x(t+1)."""
    count, n = transition.shape[:2]
    if n == 0:
        return forcing
    driven = np.zeros((count, n))
    driven[:, 0] = forcing
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(propagate(transition, driven, np.zeros(n))[1:, 0])
