"""What both estimators of θ share: the checks of their input, and rows that are white."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import cho_factor, solve_triangular

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, ShapeError
from identification.models.model import Model
from identification.models.structure import Structure
from identification.scheduling import ParameterDependence
from identification.signals import Measurement, OperatingPoint


def stacked_points(
    structure: Structure,
    dependence: ParameterDependence,
    experiments: Sequence[Measurement],
    prior: Model | None,
) -> FloatArray:
    """The operating points of the experiments (M, s), checked.

    Raises ShapeError when bases and structure do not fit, MisuseError without experiments or with a prior estimate of
    another structure, TooFewOperatingPointsError when the operating points do not determine θ and there is no prior.
    """
    if len(dependence.bases) != structure.size:
        raise ShapeError(
            f"{len(dependence.bases)} bases were given for {structure.size} coefficients; give one for each of"
            f" {', '.join(structure.coefficient_names)}",
            "basis",
        )
    if not experiments:
        raise MisuseError("no experiment was given; give at least one", "experiments")
    if prior is not None and (prior.structure != structure or prior.dependence != dependence):
        raise MisuseError("the prior estimate has another structure or other basis functions", "prior")
    points = dependence.points([experiment.operating_point for experiment in experiments])
    if prior is None:
        dependence.require_identifiable(points)
    return points


def whitener(covariance: FloatArray) -> FloatArray:
    """A triangular S with P⁻¹ = SᵀS for a covariance P, free of the units of its entries [Ghosh2018, (11)].

    Raises NotIdentifiableError when P is not finite or not positive definite.
    """
    deviations = np.sqrt(np.diag(covariance))
    if not (np.all(np.isfinite(covariance)) and np.all(deviations > 0)):
        raise NotIdentifiableError("the covariance is not finite and positive")
    try:
        factor = cho_factor(covariance / np.outer(deviations, deviations), lower=True)[0]
    except np.linalg.LinAlgError as error:
        raise NotIdentifiableError("the covariance is not positive definite") from error
    return np.asarray(solve_triangular(np.tril(factor), np.diag(1 / deviations), lower=True))


def prior_rows(prior: Model | None, size: int) -> tuple[FloatArray, FloatArray]:
    """(S, S θ̂_1) with P_θ1⁻¹ = SᵀS: what an earlier estimate adds as white rows, none without one [Ghosh2018, (13)]."""
    if prior is None:
        return np.zeros((0, size)), np.zeros(0)
    root = whitener(prior.theta_covariance)
    return root, root @ prior.theta


def place(point: OperatingPoint) -> str:
    """An operating point in words."""
    return "p = " + ", ".join(f"{value:g}" for value in point)


def asymptotics_advice(structure: Structure, experiments: Sequence[Measurement]) -> str:
    """A warning when a measurement is short for statements that hold for many samples [Ghosh2018, Remark 1]."""
    short = [e for e in experiments if len(e) < 20 * structure.size]
    if not short:
        return ""
    return (
        f"the measurement at {place(short[0].operating_point)} has only {len(short[0])} values for"
        f" {structure.size} coefficients: take the accuracy as a rough guide or measure longer"
    )


def instability_advice(structure: Structure, coefficients: FloatArray, points: FloatArray) -> str:
    """Where the model ζ (M, n) is unstable among the operating points (M, s); empty when nowhere."""
    unstable = ~structure.stable(coefficients)
    if not np.any(unstable):
        return ""
    where = place(tuple(points[unstable][0]))
    return f"the model is unstable at {where}; choose other basis functions or measure at more operating points"
