"""Between continuous and discrete time: the bilinear map with prewarped frequencies, and the zero-order hold."""

import numpy as np
from scipy.linalg import expm, logm

from identification.arrays import ComplexArray, FloatArray
from identification.errors import NotIdentifiableError, RangeError
from identification.models.system import StateSpace


def bilinear_variable(omega: FloatArray, centre: float) -> ComplexArray:
    """z of s = jω, at 2/T = `centre`, of modulus one: e^{2j arctan(ω/centre)}, so that the response stays as it is."""
    return np.exp(2j * np.arctan(omega / centre))


def from_bilinear(model: StateSpace, centre: float) -> StateSpace:
    """The continuous-time system whose bilinear image s = (2/T)(z − 1)/(z + 1), 2/T = `centre`, is `model`.

        A_c = (2/T)(A + I)⁻¹(A − I),  B_c = √(4/T) (A + I)⁻¹ B,  C_c = √(4/T) C (A + I)⁻¹,  D_c = D − C (A + I)⁻¹ B

    [Akcay2008, Identification of continuous-time models]. Raises NotIdentifiableError for a pole at z = −1, which is
    one at infinity.
    """
    one = np.eye(model.order)
    shifted = model.a + one
    if model.order and np.linalg.cond(shifted) > 1e13:
        raise NotIdentifiableError(
            "the model has a pole at infinite frequency; choose a lower order or measure higher frequencies", "order"
        )
    scale = np.sqrt(2 * centre)
    a, b = np.linalg.solve(shifted, model.a - one), np.linalg.solve(shifted, model.b)
    c = np.linalg.solve(shifted.T, model.c.T).T
    return StateSpace(np.asarray(centre * a), np.asarray(scale * b), np.asarray(scale * c), model.d - model.c @ b, None)


def from_turned(model: StateSpace, turn: float) -> StateSpace:
    """The discrete-time system that is `model` where z is replaced by (z − α)/(1 − αz), α = `turn`, |α| < 1.

    E = I + αA,  A_d = E⁻¹(A + αI),  B_d = √(1 − α²) E⁻¹ B,  C_d = √(1 − α²) C E⁻¹,  D_d = D − α C E⁻¹ B
    """
    one = np.eye(model.order)
    mixed, scale = one + turn * model.a, float(np.sqrt(1 - turn**2))
    a = np.asarray(np.linalg.solve(mixed, model.a + turn * one), dtype=np.float64)
    b = np.asarray(np.linalg.solve(mixed, model.b), dtype=np.float64)
    c = np.asarray(np.linalg.solve(mixed.T, model.c.T).T, dtype=np.float64)
    return StateSpace(a, scale * b, scale * c, model.d - turn * model.c @ b, model.sample_time)


def held(model: StateSpace, sample_time: float) -> StateSpace:
    """The samples of a continuous-time system whose input a zero-order hold makes.

    [A B; 0 I] = exp([A_c B_c; 0 0] T)
    """
    n, m = model.b.shape
    generator = np.zeros((n + m, n + m))
    generator[:n] = np.concatenate([model.a, model.b], axis=1)
    step = expm(generator * sample_time)
    return StateSpace(step[:n, :n], step[:n, n:], model.c, model.d, sample_time)


def from_hold(model: StateSpace) -> StateSpace:
    """The continuous-time system whose samples behind a zero-order hold are `model`, with |Im s| < π/T.

    Raises RangeError for a pole on the negative real axis or at zero, which no such system of this order has.
    """
    assert model.sample_time is not None
    n, m = model.b.shape
    poles = model.poles
    if np.any((poles.real <= 0) & (abs(poles.imag) <= 1e-12 * abs(poles))) or np.any(abs(poles) < 1e-14):
        raise RangeError(
            "a pole lies on the negative real axis, where no zero-order hold puts one; sample faster, choose another"
            " order or keep the model in discrete time",
            "zero_order_hold",
        )
    step = np.eye(n + m)
    step[:n] = np.concatenate([model.a, model.b], axis=1)
    generator = np.real(logm(step)) / model.sample_time
    return StateSpace(generator[:n, :n], generator[:n, n:], model.c, model.d, None)
