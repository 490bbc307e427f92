"""The residuals whose sum of squares the maximum-likelihood estimators minimise, with their exact derivatives."""

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.lti.filtering import lfilter
from identification.models.physical import RationalForm
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, Measurement, TimeRecord, require_one_channel


def residual_and_jacobian(
    structure: RationalStructure, zeta: FloatArray, data: Measurement
) -> tuple[FloatArray, FloatArray]:
    """The residual r (R,) of a measurement for ζ (n,) and ∂r/∂ζ (R, n).

    Time records: the prediction errors [Ghosh2018, (6)], of unknown variance σ_e², R = N;

        ε(t) = H⁻¹(q) (y(t) − G(q) u(t)), from rest

    Frequency responses: R = 2F, of unit variance where the variance σ_k² = E|n_k|² of the measurement is known, and
    unweighted otherwise (columns of ∂r/∂ζ_H are then zero: a frequency response says nothing about H);

        r = √2 (Re, Im)(Ĝ_k − G(ω_k; ζ)) / σ_k

    Raises MisuseError when the structure is not in the time domain of the measurement.
    """
    if isinstance(data, TimeRecord):
        return prediction_errors(structure, zeta, data)
    return response_errors(structure, zeta, data)


def prediction_errors(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, transient: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """ε(t) (N,) and ∂ε/∂ζ (N, n); see `residual_and_jacobian`.

    With `transient` x (n_a,) the plant does not start from rest, G u becomes G u + (Σ x_i q^i / A) δ with the unit
    pulse δ, and the derivatives with respect to x follow as n_a further columns.
    """
    require_same_sampling(structure, record)
    a, b, _, c, d = structure.split(zeta)
    one = np.ones(1)
    a, c, d = np.concatenate([one, a]), np.concatenate([one, c]), np.concatenate([one, d])
    u, y = record.input, record.output
    pulse = np.zeros(len(u))
    pulse[0] = 1.0
    response = lfilter(np.concatenate([np.zeros(structure.n_k), b]), a, u)
    if transient is not None and len(transient):
        response = response + lfilter(transient, a, pulse)
    disturbance = y - response
    error = lfilter(d, c, disturbance)
    through = lfilter(d, np.convolve(c, a), np.stack([response, u, pulse]))
    columns = [
        delayed(through[0], 1, structure.n_a),
        -delayed(through[1], structure.n_k, structure.n_b + 1),
        -delayed(lfilter(one, c, error), 1, structure.n_c),
        delayed(lfilter(one, c, disturbance), 1, structure.n_d),
    ]
    if transient is not None:
        columns.append(-delayed(through[2], 0, len(transient)))
    return np.asarray(error), np.concatenate(columns, axis=1)


def response_errors(
    structure: RationalForm, zeta: FloatArray, data: FrequencyResponse, weights: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """r (2F,) and ∂r/∂ζ (2F, n); see `residual_and_jacobian`. `weights` (F,) replace 1/σ_k."""
    require_same_sampling(structure, data)
    if weights is None:
        weights = np.ones(len(data)) if data.variance is None else 1 / np.sqrt(data.variance)
    error = np.sqrt(2) * weights * (data.response - structure.plant_response(zeta, data.frequencies, data.held))
    gradient = -np.sqrt(2) * weights * structure.plant_gradient(zeta, data.frequencies, data.held)
    jacobian = np.zeros((2 * len(data), structure.size))
    jacobian[:, : structure.n_plant] = np.concatenate([gradient.real, gradient.imag], axis=-1).T
    return np.concatenate([error.real, error.imag]), jacobian


def require_same_sampling(structure: RationalForm, data: Measurement) -> None:
    """Raises MisuseError when a measurement cannot be held against a model of this structure."""
    require_one_channel(data)
    if isinstance(data, TimeRecord) and (not structure.is_discrete or structure.delay):
        raise MisuseError(
            "a model in continuous time or with an estimated delay is fitted to frequency responses; estimate the"
            " frequency response of the record first",
            "structure",
        )
    theirs, ours = data.sample_time, structure.sample_time
    if (theirs is None) != (ours is None) or (theirs and ours and abs(theirs / ours - 1) > 1e-6):
        raise MisuseError(
            f"the sample time of the data is {theirs} s, that of the model {ours} s; measure at the sample time of the"
            " model or describe the plant in continuous time",
            "sample_time",
        )


def delayed(signal: FloatArray, first: int, count: int) -> FloatArray:
    """The signal delayed by first … first + count − 1 samples, as the columns of an (N, count) array."""
    columns = np.zeros((len(signal), count))
    for i in range(count):
        shift = first + i
        columns[shift:, i] = signal[: max(len(signal) - shift, 0)]
    return columns
