"""Prediction errors of a record whose initial state and operating level are not known: both are marginalised."""

from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.linalg import qr

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError
from identification.lti.filtering import lfilter
from identification.lti.free_noise import RecordInLoop, errors_in_loop, marginal_errors, with_free_noise
from identification.lti.likelihood import delayed, prediction_errors
from identification.models.rational import RationalStructure
from identification.signals import TimeRecord

InitialConditions = Literal["zero", "estimate"]


def fitted_record(
    structure: RationalStructure, record: TimeRecord, initial: InitialConditions
) -> tuple[RationalStructure, TimeRecord]:
    """What is fitted of a record: y(t + n_k) beside u(t) about their levels, and the structure without the n_k samples.

    What the plant did within the first n_k samples the input before the record did, which is not known. With "zero" the
    record stays as it is, and only stated levels come off: from rest at u = 0 a mean value is an excitation.
    A record with feedback, where the structure has no noise model of its own, gets a free one (`free_noise`), and its
    start is estimated. Raises NotIdentifiableError for a record that is not longer than the delay.
    """
    in_loop = record.feedback and structure.n_noise == 0
    if initial == "zero" and not in_loop:
        return structure, record.about_its_level() if record.level_known else record
    lag, kept = structure.n_k, len(record) - structure.n_k
    if kept < 2:
        raise NotIdentifiableError(
            f"the record of {len(record)} samples is no longer than the delay of {lag} samples; record longer", "input"
        )
    about = record.about_its_level()
    moved = replace(about, period=None, reference=None, input=about.input[:kept], output=about.output[lag:])
    if in_loop:
        return replace(structure, n_k=0), with_free_noise(replace(structure, n_k=0), moved)
    return replace(structure, n_k=0), moved


def state_size(structure: RationalStructure) -> int:
    """How many numbers sum up the input and output before a record: max(n_a, n_b) where the plant has no delay."""
    return max(structure.n_a, structure.n_b)


def free_parameters(structure: RationalStructure, initial: InitialConditions, record: TimeRecord) -> int:
    """How many unknowns one record adds: its initial state, and the output's level unless it was stated.

    None where the record is said to start from rest; those of a free noise model count as well.
    """
    if isinstance(record, RecordInLoop):
        colour = len(record.colour)
        return state_size(structure) + 2 * (record.noise_order + colour) + (0 if record.level_known else 1)
    return state_size(structure) + (0 if record.level_known else 1) if initial == "estimate" else 0


def errors_from(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> tuple[FloatArray, FloatArray]:
    """ε(t) (N,) and ∂ε/∂ζ (N, n) of a `fitted_record` at the best initial state and level x(ζ), which enter linearly.

        ε(ζ) = ε₀(ζ) + Φ(ζ) x,   x(ζ) = −Φ⁺ε₀,   J = (I − ΦΦ⁺) ∂ε/∂ζ

    Φ holds −(q^i/(H A)) δ for each state i and, where the levels were not stated, −H⁻¹ 1 for the level of the output.
    ε and Jᵀε are the exact residual and half gradient of the cost minimised over x, and (JᵀJ)⁻¹ is the block of ζ in
    the covariance of (ζ, x), so x needs no place among the parameters. With "zero" the record starts from rest.
    """
    if isinstance(record, RecordInLoop):
        found = marginal_errors(structure, zeta, record)
        return found.errors, found.jacobian
    if not free_parameters(structure, initial, record):
        return prediction_errors(structure, zeta, record)
    q, r, start_errors = _projection(structure, zeta, record)
    state, level = _best_start(structure, q, r, start_errors)
    lowered = replace(record, output=record.output - level)
    errors, jacobian = prediction_errors(structure, zeta, lowered, state)
    jacobian = jacobian[:, : structure.size]
    return errors - q @ (q.T @ errors), jacobian - q @ (q.T @ jacobian)


def errors_only(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> FloatArray:
    """ε(t) (N,) of `errors_from` without the derivatives."""
    if isinstance(record, RecordInLoop):
        return errors_in_loop(structure, zeta, record).errors
    if free_parameters(structure, initial, record):
        q, _, errors = _projection(structure, zeta, record)
        return errors - q @ (q.T @ errors)
    return _from_rest(structure, zeta, record)


def simulated_output(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord, initial: InitialConditions
) -> FloatArray:
    """G u (N,) with the response to the best initial state and the best level: the output without noise.

    In a loop y less the disturbance, which is G u where the plant is stable.
    """
    if isinstance(record, RecordInLoop):
        return record.output - errors_in_loop(structure, zeta, record).disturbance
    a, b, _, _, _ = structure.split(zeta)
    denominator = np.concatenate([[1.0], a])
    pulses = np.zeros(len(record))
    output = lfilter(np.concatenate([np.zeros(structure.n_k), b]), denominator, record.input)
    if free_parameters(structure, initial, record):
        q, r, errors = _projection(structure, zeta, record)
        pulses[: state_size(structure)], level = _best_start(structure, q, r, errors)
        output = output + lfilter([1.0], denominator, pulses) + level
    return np.asarray(output)


def _from_rest(structure: RationalStructure, zeta: FloatArray, record: TimeRecord) -> FloatArray:
    a, b, _, c, d = structure.split(zeta)
    plant = np.concatenate([np.zeros(structure.n_k), b]), np.concatenate([[1.0], a])
    disturbance = record.output - lfilter(*plant, record.input)
    return np.asarray(lfilter(np.concatenate([[1.0], d]), np.concatenate([[1.0], c]), disturbance))


def _best_start(
    structure: RationalStructure, q: FloatArray, r: FloatArray, errors: FloatArray
) -> tuple[FloatArray, float]:
    """The initial state and the level of the output, which is zero where it was stated."""
    start = -np.linalg.lstsq(r, q.T @ errors, rcond=1e-13)[0]
    size = state_size(structure)
    return np.asarray(start[:size], dtype=np.float64), float(start[size:].sum())


def level_errors(structure: RationalStructure, zeta: FloatArray, count: int) -> FloatArray:
    """−H⁻¹ 1 (N,): what a unit of the output's level takes from the prediction errors of a record of N samples."""
    _, _, _, c, d = structure.split(zeta)
    whitening = np.concatenate([[1.0], d]), np.concatenate([[1.0], c])
    return np.asarray(-lfilter(*whitening, np.ones(count)))


def _projection(
    structure: RationalStructure, zeta: FloatArray, record: TimeRecord
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Orthonormal basis of the columns of Φ, the triangular factor with Φ = Q R, and the errors from rest."""
    a, _, _, c, d = structure.split(zeta)
    pulse = np.zeros(len(record))
    pulse[0] = 1.0
    a, c, d = (np.concatenate([[1.0], part]) for part in (a, c, d))
    through = lfilter(d, np.convolve(c, a), pulse)
    columns = -delayed(through, 0, state_size(structure))
    if not record.level_known:
        columns = np.column_stack([columns, level_errors(structure, zeta, len(record))])
    q, r = qr(columns, mode="economic", check_finite=False)
    return np.asarray(q, dtype=np.float64), np.asarray(r, dtype=np.float64), _from_rest(structure, zeta, record)
