"""What a parametric subspace estimate hands back: the model, its errors, its basis, and what is known of its poles."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.arrays import FloatArray
from identification.models.model import Model
from identification.outcome import Outcome
from identification.parametric.canonical_rows import CanonicalRows
from identification.signals import FrequencyResponse


@dataclass(frozen=True)
class ResponseError:
    """How far a model is from a measured response Ĝ at one operating point, Frobenius norms over outputs and inputs.

    `maximum` = max_i ‖Ĝ_i − G_i‖, `rms` = (mean_i ‖Ĝ_i − G_i‖²)^½, `relative` = (Σ ‖Ĝ_i − G_i‖² / Σ ‖Ĝ_i‖²)^½.
    """

    operating_point: tuple[float, ...]
    maximum: float
    rms: float
    relative: float


@dataclass(frozen=True)
class RegionReport:
    """What a pole region asked for, what it guarantees and what it cost.

    `where`: "whole range" when the inequality at the corners of the range proves it everywhere, "grid" when it was
    imposed on a grid only; `points`: how many operating points that was. `certificate`: below zero proves the poles at
    these points (and everywhere for "whole range") inside. `worst_excess`: the largest f(λ) over a fine grid of the
    range, `worst_excess_without` that of the model without region, `error` and `error_without` the relative errors of
    both models over all data.
    """

    where: Literal["whole range", "grid"]
    points: int
    certificate: float
    worst_excess: float
    worst_excess_without: float
    error: float
    error_without: float


@dataclass(frozen=True, eq=False)
class ParametricEstimate:
    """A parametric state-space model with its outcome and errors at each operating point.

    `singular_values`: those of each operating point, largest first, from which the order shows; `rows`: the choice of
    rows behind the state basis; `region`: None when no pole region was asked for.
    """

    model: Model
    outcome: Outcome
    errors: tuple[ResponseError, ...]
    singular_values: tuple[FloatArray, ...]
    rows: CanonicalRows
    region: RegionReport | None = None


def response_errors(model: Model, experiments: Sequence[FrequencyResponse]) -> tuple[ResponseError, ...]:
    """The errors of a model at every operating point of the data."""
    return tuple(_error(model, data) for data in experiments)


def _error(model: Model, data: FrequencyResponse) -> ResponseError:
    deviation = data.matrices - model.frequency_response([data.operating_point], data.frequencies)[0]
    norms = np.linalg.norm(deviation, axis=(1, 2))
    size = float(np.linalg.norm(data.matrices))
    relative = float(np.linalg.norm(norms)) / size if size else np.inf
    return ResponseError(data.operating_point, float(norms.max()), float(np.sqrt(np.mean(norms**2))), relative)


def overall_error(model: Model, experiments: Sequence[FrequencyResponse]) -> float:
    """‖(Ĝ − G)/σ‖ / ‖Ĝ/σ‖ over all operating points, σ² the variances of the data (equal when none are stated)."""
    above = below = 0.0
    for data in experiments:
        deviation = data.matrices - model.frequency_response([data.operating_point], data.frequencies)[0]
        weights = 1.0 if data.variance is None else data.variance.reshape(deviation.shape) ** -0.5
        above += float(np.sum(abs(weights * deviation) ** 2))
        below += float(np.sum(abs(weights * data.matrices) ** 2))
    return float(np.sqrt(above / below))
