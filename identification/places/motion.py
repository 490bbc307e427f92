"""Displacement and flow of a plant from an output that is either of them, or the rate of the flow."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.channels import Channels
from identification.comparison.batch import Batch


def powers(batch: Batch, exponent: int) -> ComplexArray:
    """(jω)^exponent (K,); zero at the Nyquist line, whose phase is not known, and at ω = 0 unless the exponent is 0."""
    if exponent == 0:
        return np.ones(len(batch.omega), dtype=np.complex128)
    moving = ~batch.real
    result = np.zeros(len(batch.omega), dtype=np.complex128)
    result[moving] = (1j * batch.omega[moving]) ** exponent
    return result


def displacement(core: ComplexArray, mean: FloatArray, batch: Batch, order: int) -> ComplexArray:
    """Lines (M, K) of q = s^(−d) x; for d ≥ 1 the record does not show its mean (M,), which is stated."""
    lines = core * powers(batch, -order)
    if order:
        lines[:, 0] = mean
    return np.asarray(lines)


def flow_rate(core: ComplexArray, batch: Batch, order: int) -> ComplexArray:
    """Lines (M, K) of q̇ = s^(1−d) x."""
    return np.asarray(core * powers(batch, 1 - order))


def static_stiffness(response: ComplexArray, batch: Batch, order: int) -> FloatArray:
    """The force per displacement at rest (M,) of a plant with response G (M, K) to s^d q; zero for a free one.

    The limit of Re (jω)^d/G for ω → 0 from the two lowest lines, as K − m ω² + … [Nayfeh1979, Section 2.3].
    """
    lowest = np.flatnonzero(~batch.real)[:2]
    seen = np.real((1j * batch.omega[lowest]) ** order / response[:, lowest])
    if len(lowest) < 2:
        return np.asarray(np.maximum(seen[:, 0], 0.0))
    w0, w1 = batch.omega[lowest] ** 2
    limit = (w1 * seen[:, 0] - w0 * seen[:, 1]) / (w1 - w0)
    return np.asarray(np.where(np.isfinite(limit), np.maximum(limit, 0.0), 0.0))


def motions(channels: Channels) -> tuple[tuple[int, bool], ...]:
    """Which motions may carry the forces: (order d, whether it is the input that is the motion).

    That of the output where its quantity is a motion; that of the input where the output is an effort and the input is
    a motion; where both are efforts the output may be one across a compliance or across a resistance, so that it goes
    with the displacement or the flow. Without a stated quantity of the output every order of it.
    """
    output, input = channels.output, channels.input
    if output.quantity is None:
        return ((0, False), (1, False), (2, False))
    if output.order is not None:
        return ((output.order, False),)
    if input.order is not None:
        return ((input.order, True),)
    return ((0, False), (1, False))
