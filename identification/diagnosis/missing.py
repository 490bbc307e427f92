"""The smooth picture of what a model lacks, over operating point and frequency."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray, IntArray
from identification.comparison.batch import EXCITED, Batch
from identification.extension.fit import Fit

WIDTH = 0.06


@dataclass(frozen=True, eq=False)
class MissingResponse:
    """What is missing from the response, δG (M, F) at `frequencies` (F,) rad/s, with the standard deviation of |δG|.

    `points` (M, s), `members` (M,) say which measurement each row is, `ports` (M, 2) which output and input, from 0.
    """

    points: FloatArray
    frequencies: FloatArray
    response: ComplexArray
    deviation: FloatArray
    members: IntArray
    ports: IntArray | None = None


def missing_response(found: Fit, count: int = 60, width: float = WIDTH) -> tuple[MissingResponse, ...]:
    """Kernel estimates of (Y − Ŷ)/U over the logarithm of frequency, one table a grid.

        δG(ω) = Σ_k w_k U_k* (Y_k − Ŷ_k)/σ_k² / Σ_k w_k |U_k|²/σ_k²,   w_k = exp(−(ln ω_k − ln ω)²/2h²)

    h = `width` times the logarithm of the ratio of the highest to the lowest excited frequency; `count` frequencies.
    """
    pairs = zip(found.rows.batches, found.flows, strict=True)
    return tuple(_smoothed(batch, batch.outputs - flow.output, count, width) for batch, flow in pairs)


def explained_response(found: Fit, grown: Fit, count: int = 60, width: float = WIDTH) -> tuple[MissingResponse, ...]:
    """What a fit with an effect more explains of the missing response: the same estimates of (Ŷ_grown − Ŷ)/U."""
    triples = zip(found.rows.batches, found.flows, grown.flows, strict=True)
    return tuple(_smoothed(batch, more.output - flow.output, count, width) for batch, flow, more in triples)


def _smoothed(batch: Batch, change: ComplexArray, count: int, width: float) -> MissingResponse:
    low, high = batch.band
    grid = np.geomspace(low, high, count)
    lines = np.flatnonzero(batch.omega > 0)
    distance = np.log(batch.omega[lines][None] / grid[:, None]) / (width * np.log(high / low))
    kernel = np.exp(-(distance**2) / 2)
    used = (batch.classes[:, lines] == EXCITED) & np.isfinite(batch.variances[:, lines])
    inputs = batch.inputs[:, lines]
    weight = np.where(used, 1 / batch.variances[:, lines], 0.0)
    information = (weight * abs(inputs) ** 2) @ kernel.T
    response = (weight * inputs.conj() * change[:, lines]) @ kernel.T / information
    deviation = np.sqrt((weight * abs(inputs) ** 2) @ (kernel**2).T) / information
    return MissingResponse(batch.points, grid, response, deviation, batch.members, batch.ports)
