"""Designs: requests to problems of oed, what oed found to documents."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import block_diag

from app.arrays import finite_or_none
from app.schemas.designs import MAX_POINTS, AxesGrid, Box, DecisionDocument, DesignRequest, PointGrid, PromiseDocument
from identification.arrays import FloatArray
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.model import Model
from identification.scheduling import OneVariableBasis, ParameterDependence
from oed.decisions import Decision
from oed.limits.limit import Limit

if TYPE_CHECKING:
    from oed.robust import Kept

SAME_POINT = 1e-9


@dataclass(frozen=True)
class _OnWholeRange:
    """Basis functions that keep the range that they were defined on when the range of the search is a part of it."""

    basis: OneVariableBasis
    minimum: float
    maximum: float

    @property
    def size(self) -> int:
        return self.basis.size

    def evaluate(self, p: FloatArray, minimum: float, maximum: float) -> FloatArray:
        """The functions at p (M,), as (M, size)."""
        return self.basis.evaluate(p, self.minimum, self.maximum)


def candidate_points(request: DesignRequest, dependence: ParameterDependence) -> FloatArray:
    """The operating points (M, s) to choose from, without excluded ones; raises ShapeError and RangeError."""
    given = request.operating_points
    if isinstance(given, PointGrid):
        points = dependence.points(_rectangular(given.points))
    else:
        points = dependence.points(_grid(given))
    excluded = dependence.points(_rectangular(request.excluded_points)) if request.excluded_points else points[:0]
    spans = np.array([v.maximum - v.minimum for v in dependence.variables])
    kept = [point for point in points if not _is_among(point, excluded, spans)]
    if not kept:
        raise RangeError("all operating points are excluded", "excluded_points")
    return np.array(kept)


def energy_caps(request: DesignRequest, points: FloatArray, dependence: ParameterDependence) -> FloatArray | None:
    """α (M,), infinite where there is no cap; None when there is none at all."""
    caps = request.energy_caps
    if caps is None or (caps.default is None and not caps.per_point):
        return None
    spans = np.array([v.maximum - v.minimum for v in dependence.variables])
    limits = np.full(len(points), np.inf if caps.default is None else caps.default)
    for cap in caps.per_point:
        same = np.all(abs(points - np.array(cap.operating_point)) <= SAME_POINT * spans, axis=1)
        if not same.any():
            raise RangeError(f"{cap.operating_point} is none of the operating points to choose from", "energy_caps")
        limits[same] = cap.energy
    return limits


def plant_limits(request: DesignRequest, model: Model, points: FloatArray) -> tuple[Limit, ...]:
    """What the plant may not do; raises MisuseError that points to a limit at none of the operating points (M, s)."""
    limits: list[Limit] = [given.build() for given in request.limits]
    if limits and isinstance(request.operating_points, Box):
        raise MisuseError("limits of the plant belong to the points of a grid; give a grid", "/limits")
    for i, limit in enumerate(limits):
        try:
            limit.most(model, points)
        except MisuseError as error:
            raise MisuseError(str(error), f"/limits/{i}/operatingPoints") from error
    return tuple(limits)


def searched_model(request: DesignRequest, model: Model) -> Model:
    """The model with its range narrowed to the box, when the design searches one."""
    box = request.operating_points
    if not isinstance(box, Box):
        return model
    variables = model.dependence.variables
    model.dependence.points(_rectangular([box.minimum, box.maximum]))
    ranges = zip(box.minimum, box.maximum, strict=True)
    narrowed = tuple(
        replace(variable, minimum=low, maximum=high) for variable, (low, high) in zip(variables, ranges, strict=True)
    )
    bases = tuple(
        replace(
            basis,
            factors=tuple(
                _OnWholeRange(factor, variable.minimum, variable.maximum)
                for factor, variable in zip(basis.factors, variables, strict=True)
            ),
        )
        for basis in model.dependence.bases
    )
    return replace(model, dependence=ParameterDependence(narrowed, bases))


def prior_information(model: Model, known: bool) -> FloatArray:
    """P⁻¹ of θ_G, the parameters of the effects and θ_H; raises MisuseError when P is not known or singular."""
    if not model.effects:
        if not known:
            raise MisuseError("the model has no covariance that could be prior information", "use_prior_information")
        return _inverse(model.theta_covariance)
    if model.joint_covariance is None:
        raise MisuseError("the model has no covariance that could be prior information", "use_prior_information")
    noise = model.noise_size
    return np.asarray(block_diag(_inverse(model.joint_covariance), np.zeros((noise, noise))))


def _inverse(covariance: FloatArray) -> FloatArray:
    scale = np.sqrt(np.diagonal(covariance))
    if np.any(scale <= 0) or np.linalg.cond(covariance / np.outer(scale, scale)) > 1e13:
        raise MisuseError("the covariance of the model is singular", "use_prior_information")
    inverse = np.linalg.inv(covariance / np.outer(scale, scale)) / np.outer(scale, scale)
    return np.asarray((inverse + inverse.T) / 2)


def promise(kept: "Kept") -> dict[str, Any]:
    """How a promise is kept, as JSON."""
    return PromiseDocument(
        asked_probability=kept.probability,
        kept=kept.kept,
        checked=kept.checked,
        lowest_probability=kept.lowest,
        highest_probability=kept.highest,
        scenarios=kept.scenarios,
        scenario_gap=kept.scenario_gap,
        scaling=kept.scaling,
        energy_at_estimate=kept.energy_at_estimate,
        unstable_draws=kept.unstable,
    ).as_json()


def decision_document(target: int, decision: Decision) -> DecisionDocument:
    """What can be decided about an effect."""
    demand, detection = decision.demand, decision.demand.against is None
    return DecisionDocument(
        target_index=target,
        question=decision.question,
        effect=demand.kind,
        against=demand.against,
        amplitude=demand.amplitude if detection else None,
        expected_variance=finite_or_none(decision.variance) if detection else None,
        noncentrality=decision.noncentrality,
        asked_power=demand.rates.power,
        level=demand.rates.level,
        expected_power=decision.power,
        probability_of_weight_above95=decision.conviction,
    )


def _grid(given: AxesGrid | Box) -> FloatArray:
    if isinstance(given, AxesGrid):
        spans = [(axis.minimum, axis.maximum, axis.count) for axis in given.axes]
    elif len(given.minimum) != len(given.maximum):
        raise ShapeError("minimum and maximum differ in length", "operating_points")
    else:
        spans = [(low, high, given.starting_count) for low, high in zip(given.minimum, given.maximum, strict=True)]
    if np.prod([float(count) for _, _, count in spans]) > MAX_POINTS:
        raise RangeError(f"the grid has more than {MAX_POINTS} points", "operating_points")
    if any(low > high or (low == high and count > 1) for low, high, count in spans):
        raise RangeError("each axis must rise", "operating_points")
    return np.array(list(product(*(np.linspace(low, high, count) for low, high, count in spans))))


def _rectangular(points: Sequence[Sequence[float]]) -> FloatArray:
    if len({len(point) for point in points}) > 1:
        raise ShapeError("the operating points differ in length", "operating_points")
    return np.array(points, dtype=float)


def _is_among(point: FloatArray, others: FloatArray, spans: FloatArray) -> bool:
    return bool(np.any(np.all(abs(others - point) <= SAME_POINT * spans, axis=1)))
