"""How well a simulated output meets the measured one, in %."""

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError


def best_fit_rate(output: FloatArray, simulated: FloatArray) -> float:
    """How well ŷ (N, n_y) meets y (N, n_y), in % [Cox2018, (24)].

    BFR = 100 max{1 − Σ_t ‖y(t) − ŷ(t)‖ / Σ_t ‖y(t) − ȳ‖, 0}
    """
    _same_shape(output, simulated)
    errors = np.linalg.norm(output - simulated, axis=-1).sum()
    total = np.linalg.norm(output - output.mean(axis=0), axis=-1).sum()
    return _percent(float(errors), float(total))


def variance_accounted_for(output: FloatArray, simulated: FloatArray) -> float:
    """How much of the variance of y (N, n_y) is explained by ŷ (N, n_y), in % [Goos2014, (30); Cox2018, (25)].

    VAF = 100 max{1 − Σ_t ‖y(t) − ŷ(t) − ē‖² / Σ_t ‖y(t) − ȳ‖², 0},   ē the mean of y − ŷ
    """
    _same_shape(output, simulated)
    error = output - simulated
    return _percent(
        float(np.sum((error - error.mean(axis=0)) ** 2)), float(np.sum((output - output.mean(axis=0)) ** 2))
    )


def _same_shape(output: FloatArray, simulated: FloatArray) -> None:
    if output.ndim != 2 or output.shape != simulated.shape:
        raise ShapeError(
            f"output has shape {output.shape}, simulation {simulated.shape}; give (N, n_y) twice", "output"
        )


def _percent(error: float, total: float) -> float:
    if not total > 0:
        raise RangeError("the output is constant: no part of its variation can be explained", "output")
    if not np.isfinite(error):
        raise RangeError("the simulation holds values that are not finite", "simulated")
    return 100 * max(1 - error / total, 0.0)
