"""Parametric state-space models from frequency responses at several operating points, by subspaces."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError, ShapeError
from identification.models.model import Model
from identification.models.state_space_model import state_space_model
from identification.outcome import Outcome
from identification.parametric.canonical_rows import canonical, choose_rows, misfit_weight
from identification.parametric.conic_programme import Misfit
from identification.parametric.equations import ShiftEquations, input_matrices, shift_equations
from identification.parametric.estimate import (
    ParametricEstimate,
    RegionReport,
    overall_error,
    response_errors,
)
from identification.parametric.local_subspace import Weighting, local_subspace
from identification.parametric.pole_constraint import constrained_dynamics
from identification.parametric.pole_guarantee import corners_suffice, grid, judged, stability_advice, worst_excess
from identification.parametric.shift_basis import shift_basis
from identification.pole_regions.inequality import PoleRegion
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse


@dataclass(frozen=True)
class ParametricSubspace:
    """A(p), B(p), C(p), D(p) from frequency responses at frozen operating points [Kergus2019, Algorithms 1 and 2].

        O_m from each response,  O_m ← O_m (S O_m)⁻¹,  Ψ A_aug = Δ_aug,  Γ C_aug = Λ_aug,  B and D by (16)

    with the same rows S at all operating points, chosen for the best conditioning. In discrete time with `weighting`
    "none" the observability matrix has the block rows C A^k of the paper; otherwise C φ_k(A) with φ_k orthonormal over
    all lines, which is well conditioned in continuous time too and, with "variance" (the noise's as stated by the
    data, equal everywhere when they state none), spans the same subspace. With a `region` A comes from the
    semidefinite programme of Algorithm 2.
    """

    kind: ClassVar[str] = "parametric_subspace"
    data: ClassVar[type] = FrequencyResponse

    order: Annotated[int, "number of states n"]
    block_rows: Annotated[int | None, "block rows q > n of the observability matrix, None for 2 n"] = None
    weighting: Annotated[Weighting, "weight of the subspaces: the stated variances of the noise, or none"] = "variance"
    rows_per_output: Annotated[tuple[int, ...] | None, "rows of each output that make the state, None for the best"] = (
        None
    )
    region: Annotated[PoleRegion | None, "where all poles must lie, None for anywhere"] = None
    margin: Annotated[float, "how far inside the region, as largest eigenvalue of its matrix inequality"] = 1e-5
    misfit: Annotated[Misfit, "norm of the subspaces' misfit in the programme with a region"] = "frobenius"
    grid_count: Annotated[int, "values of each variable where the region is imposed, when corners do not suffice"] = 17

    def __post_init__(self) -> None:
        if self.order < 1:
            raise RangeError(f"the order is {self.order}; it must be one or more", "order")
        if self.q <= self.order:
            raise RangeError(
                f"the observability matrix has q = {self.q} block rows for order {self.order}; take q above the order",
                "block_rows",
            )
        if self.grid_count < 2:
            raise RangeError(f"the grid has {self.grid_count} values; it needs two or more", "grid_count")
        if self.region is not None:
            self.region.require_points()
            _require_margin(self.region, self.margin)

    @property
    def q(self) -> int:
        """Block rows of the observability matrix."""
        return max(2 * self.order, 2) if self.block_rows is None else self.block_rows

    def estimate(self, dependence: ParameterDependence, experiments: Sequence[FrequencyResponse]) -> ParametricEstimate:
        """The model from M responses; `dependence` has the bases of A, B, C and D, in this order.

        Exact for noise-free data of a plant whose matrices in observability canonical form are such sums, given at
        least q + n lines at every operating point. With a region and functions of A that are affine in each variable
        the poles lie in it everywhere in the range; else where it was imposed, and the outcome says so.
        Raises TooFewOperatingPointsError, NotIdentifiableError (too few lines for q), ShapeError or MisuseError for
        data that do not fit together.
        """
        points = _checked(self, dependence, experiments)
        lines = [_variable(data) for data in experiments]
        powers = self.weighting == "none" and experiments[0].sample_time is not None
        basis = shift_basis(np.concatenate(lines), self.q, "powers" if powers else "orthonormal")
        subspaces = [
            local_subspace(data, z, basis, self.order, self.weighting)
            for data, z in zip(experiments, lines, strict=True)
        ]
        rows = choose_rows(
            [subspace.observability for subspace in subspaces], experiments[0].output_count, self.rows_per_output
        )
        shared = [canonical(subspace.observability, rows) for subspace in subspaces]
        singular_values = tuple(subspace.singular_values for subspace in subspaces)
        weight = misfit_weight([s.observability for s in subspaces], singular_values, rows)
        problem = _Problem(
            shift_equations(shared, basis, dependence, points), dependence, points, experiments, lines, weight
        )
        model = problem.model(problem.equations.dynamics())
        outcome, report = Outcome("converged", stability_advice(model), 1), None
        if self.region is not None:
            model, outcome, report = self._constrained(self.region, problem, model)
        return ParametricEstimate(model, outcome, response_errors(model, experiments), singular_values, rows, report)

    def _constrained(self, region: PoleRegion, problem: "_Problem", free: Model) -> tuple[Model, Outcome, RegionReport]:
        basis, variables = problem.dependence.bases[0], problem.dependence.variables
        corners = corners_suffice(basis, variables)
        places = grid(variables, 2 if corners else self.grid_count)
        functions = basis.evaluate(places, variables)
        found = constrained_dynamics(problem.equations, region, self.margin, functions, self.misfit, problem.weight)
        model = problem.model(found.dynamics)
        report = RegionReport(
            "whole range" if corners else "grid",
            len(places),
            found.certificate,
            worst_excess(model, region)[0],
            worst_excess(free, region)[0],
            overall_error(model, problem.experiments),
            overall_error(free, problem.experiments),
        )
        return model, judged(model, report, found.solved, found.iterations), report

    @classmethod
    def example(cls) -> "ParametricSubspace":
        """A small one, for the conformance tests."""
        return cls(order=1, block_rows=4)


@dataclass(frozen=True, eq=False)
class _Problem:
    """All that is known once the subspaces are: what is left is A."""

    equations: ShiftEquations
    dependence: ParameterDependence
    points: FloatArray
    experiments: Sequence[FrequencyResponse]
    lines: Sequence[ComplexArray]
    weight: FloatArray

    def model(self, dynamics: FloatArray) -> Model:
        """The model with these A_j, its C, B and D by least squares."""
        c = self.equations.outputs()
        b, d = input_matrices(dynamics, c, self.experiments, self.lines, self.dependence, self.points)
        sample_time = self.experiments[0].sample_time
        return state_space_model(self.dependence.variables, self.dependence.bases, (dynamics, b, c, d), sample_time)


def _variable(data: FrequencyResponse) -> ComplexArray:
    s = 1j * data.frequencies
    return np.asarray(s if data.sample_time is None else np.exp(s * data.sample_time))


def _checked(
    method: ParametricSubspace, dependence: ParameterDependence, experiments: Sequence[FrequencyResponse]
) -> FloatArray:
    """The operating points (M, s), once everything fits together."""
    if len(dependence.bases) != 4:
        raise ShapeError(f"{len(dependence.bases)} bases were given; give those of A, B, C and D", "dependence")
    if not experiments:
        raise ShapeError("no frequency responses were given; give one at each operating point", "experiments")
    first = experiments[0]
    for data in experiments:
        if data.matrices.shape[1:] != first.matrices.shape[1:]:
            raise ShapeError(
                f"the responses have {first.matrices.shape[1:]} and {data.matrices.shape[1:]} outputs × inputs; give"
                " the same channels at all operating points",
                "experiments",
            )
        if data.sample_time != first.sample_time:
            raise MisuseError(
                f"the responses have sample times {first.sample_time} and {data.sample_time}; give one for all",
                "experiments",
            )
        if len(data) < method.q + method.order:
            raise NotIdentifiableError(
                f"{len(data)} lines at operating point {data.operating_point} are too few for q = {method.q} block rows"
                f" and order {method.order}; measure {method.q + method.order} lines or more, or take fewer block rows",
                "frequencies",
            )
    points = dependence.points([data.operating_point for data in experiments])
    dependence.require_identifiable(points)
    return points


def _require_margin(region: PoleRegion, margin: float) -> None:
    if not 0 < margin < np.inf:
        raise RangeError(f"the margin is {margin}; it must be a positive number", "margin")
    depth = region.depth
    if depth <= margin:
        raise RangeError(
            f"the pole region is empty with a margin of {margin:g}: its deepest point has {depth:.3g}, which is"
            f" {margin - depth:.3g} too little; take a smaller margin or a larger region",
            "margin",
        )
