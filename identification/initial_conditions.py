"""Prediction errors of a record that does not start from rest: the unknown initial state is fitted and marginalised."""

from typing import Literal

import numpy as np
from scipy.linalg import qr

from identification.arrays import FloatArray
from identification.filtering import lfilter
from identification.likelihood import delayed, prediction_errors
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord

InitialConditions = Literal["zero", "estimate"]


def free_parameters(structure: RationalStructure, initial: InitialConditions) -> int:
    """How many entries the unknown initial state of one record has: n_a when it is estimated, otherwise none."""
    return structure.n_a if initial == "estimate" else 0


def errors_from(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> tuple[FloatArray, FloatArray]:
    """ε(t) (N,) and ∂ε/∂ζ (N, n) at the best initial state x(ζ) of the plant, which enters linearly.

        ε(ζ) = ε₀(ζ) + Φ(ζ) x,   x(ζ) = −Φ⁺ε₀,   J = (I − ΦΦ⁺) ∂ε/∂ζ

    ε and Jᵀε are the exact residual and half gradient of the cost minimised over x, and (JᵀJ)⁻¹ is the block of ζ in
    the covariance of (ζ, x), so x needs no place among the parameters. With "zero" the record starts from rest.
    """
    if not free_parameters(structure, initial):
        return prediction_errors(structure, zeta, record)
    q, r, start_errors = _projection(structure, zeta, record)
    errors, jacobian = prediction_errors(structure, zeta, record, _best_state(q, r, start_errors))
    jacobian = jacobian[:, : structure.size]
    return errors - q @ (q.T @ errors), jacobian - q @ (q.T @ jacobian)


def errors_only(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> FloatArray:
    """ε(t) (N,) of `errors_from` without the derivatives."""
    if free_parameters(structure, initial):
        q, _, errors = _projection(structure, zeta, record)
        return errors - q @ (q.T @ errors)
    return _from_rest(structure, zeta, record)


def simulated_output(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> FloatArray:
    """G u (N,) with the response to the best initial state added: the output without noise, as the model sees it."""
    a, b, _, _, _ = structure.split(zeta)
    denominator = np.concatenate([[1.0], a])
    pulses = np.zeros(len(record))
    output = lfilter(np.concatenate([np.zeros(structure.n_k), b]), denominator, record.input)
    if free_parameters(structure, initial):
        q, r, errors = _projection(structure, zeta, record)
        pulses[: structure.n_a] = _best_state(q, r, errors)
        output = output + lfilter([1.0], denominator, pulses)
    return np.asarray(output)


def _from_rest(structure: RationalStructure, zeta: FloatArray, record: TimeRecord) -> FloatArray:
    a, b, _, c, d = structure.split(zeta)
    plant = np.concatenate([np.zeros(structure.n_k), b]), np.concatenate([[1.0], a])
    disturbance = record.output - lfilter(*plant, record.input)
    return np.asarray(lfilter(np.concatenate([[1.0], d]), np.concatenate([[1.0], c]), disturbance))


def _best_state(q: FloatArray, r: FloatArray, errors: FloatArray) -> FloatArray:
    return np.asarray(-np.linalg.lstsq(r, q.T @ errors, rcond=1e-13)[0], dtype=np.float64)


def _projection(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Orthonormal basis of the columns of Φ (N, n_a), the triangular factor with Φ = Q R, and the errors from rest."""
    a, _, _, c, d = structure.split(zeta)
    pulse = np.zeros(len(record))
    pulse[0] = 1.0
    a, c, d = (np.concatenate([[1.0], part]) for part in (a, c, d))
    through = lfilter(d, np.convolve(c, a), pulse)
    q, r = qr(-delayed(through, 0, structure.n_a), mode="economic", check_finite=False)
    return np.asarray(q, dtype=np.float64), np.asarray(r, dtype=np.float64), _from_rest(structure, zeta, record)
