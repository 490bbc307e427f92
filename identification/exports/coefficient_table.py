"""ζ(p) over the range as a table with standard deviations."""

import csv
import io

import numpy as np
from typing_extensions import override

from identification.arrays import FloatArray
from identification.exports import Export
from identification.models.model import Model

POINTS = {1: 201, 2: 41, 3: 15}


class CoefficientTable(Export):
    """CSV: one line an operating point of a grid over the range, ζ_i(p) and √(T(p) P_θ T(p)ᵀ)_ii [Ghosh2018, (3)].

    Without a covariance there are no deviations.
    """

    kind = "coefficients"
    title = "coefficients over the range (CSV)"
    ending = "csv"

    @classmethod
    @override
    def written(cls, model: Model) -> str:
        points = _grid(model)
        zeta = model.coefficients(points)
        names = model.structure.coefficient_names
        columns = dict(zip((one.name for one in model.dependence.variables), points.T, strict=True))
        columns |= dict(zip(names, zeta.T, strict=True))
        if model.covariance is not None and np.any(model.covariance):
            deviations = coefficient_deviations(model, points, model.covariance)
            columns |= dict(zip((f"sd_{name}" for name in names), deviations.T, strict=True))
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(zip(*(map(repr, column.tolist()) for column in columns.values()), strict=True))
        return text.getvalue()


def coefficient_deviations(model: Model, points: FloatArray, covariance: FloatArray) -> FloatArray:
    """Standard deviations of ζ(p) at points (M, s) with the covariance (k, k) of θ, as (M, n)."""
    n = model.structure.size
    by_zeta = np.broadcast_to(np.eye(n, dtype=np.complex128), (len(points), n, n))
    by_theta = model.dependence.pulled(by_zeta, points).real
    return np.asarray(np.sqrt(np.sum(by_theta @ covariance * by_theta, axis=-1)))


def _grid(model: Model) -> FloatArray:
    variables = model.dependence.variables
    count = POINTS.get(len(variables), 5)
    axes = [np.linspace(one.minimum, one.maximum, count) for one in variables]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=-1)
