"""Maximum likelihood of a parametric state-space model on frequency responses, from a start."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError, NotIdentifiableError
from identification.estimates import Estimate
from identification.least_squares import LeastSquaresSolution, levenberg_marquardt
from identification.lti.response_tests import real_count, variance_inflation
from identification.lti.whiteness import chi_square
from identification.models.model import Model
from identification.models.state_space_model import charted
from identification.outcome import Outcome
from identification.parametric.more_starts import drawn_starts
from identification.parametric.pole_guarantee import fine_grid, grid
from identification.parametric.state_space_residuals import entry_gradient, residual_and_jacobian, whitener
from identification.parametric.triangular import triangular_factor
from identification.pole_regions.inequality import PoleRegion
from identification.signals import FrequencyResponse

PRECISION = 3e-5  # the search ends when the misfit could fall by less than this squared
ACCEPTED_FIT, CANDIDATES = 1e-4, 40
KNOWN = 1e-12  # smaller variances, relative to the largest, are those of directions that no response shows
EFFECTIVE = 1e-7  # smaller changes of the response, relative to the largest, are taken for none


@dataclass(frozen=True)
class StateSpaceLikelihood:
    """All entries of A_j, B_j, C_j, D_j by maximum likelihood on all responses together.

        min_θ Σ_m Σ_i ‖W_i vec(Ĝ_i − G(p_m, ω_i; θ))‖²                          [PintelonSchoukens2012, Chapter 9]

    The search moves in data-driven local coordinates, the directions of θ that change the responses, chosen anew in
    every round [McKelvey2004]. With a `region` no step is taken after which a pole leaves it at the operating points
    of a grid; a proof for those between is not given. Without one, models around the best are tried too where the fit
    is worse than known noise allows. Where the entries can do more than the plant needs, some
    directions are hardly determined and the covariance, exact to first order in the noise, is too optimistic. The
    variance of the noise is 1 when the data state variances, else it is estimated.
    """

    kind: ClassVar[str] = "state_space_likelihood"
    data: ClassVar[type] = FrequencyResponse

    region: Annotated[PoleRegion | None, "where all poles must stay, None for anywhere"] = None
    margin: Annotated[float, "how far inside the region, as largest eigenvalue of its matrix inequality"] = 1e-6
    rounds: Annotated[int, "most changes of the local coordinates"] = 10
    max_iterations: Annotated[int, "most iterations of each round"] = 30
    more_starts: Annotated[int, "how often more first models are drawn while known noise does not explain the fit"] = 3
    seed: Annotated[int, "of the generator that draws them"] = 0

    def estimate(self, start: Model, experiments: Sequence[FrequencyResponse], prior: Model | None = None) -> Estimate:
        """The refined model with the covariance of its entries, with a test of fit where the variances are known.

        With a `prior`, the estimate of the same model from other data, such as a record along p(t), the search begins
        there and ‖P^{−½}(θ − θ_prior)‖² is added, P among the state bases nearest to that of the prior.

        Raises NotIdentifiableError for fewer real numbers than parameters, MisuseError for a start outside the region
        or of another sample time or size than the data.
        """
        if prior is not None:
            return self._with_prior(prior, experiments)
        self._check(start, experiments)
        best = self._searched(start, experiments, self.rounds)
        generator = np.random.default_rng(self.seed)
        for _ in range(0 if self.region is not None else self.more_starts):
            if _fits(best):
                break
            drawn = drawn_starts(best.model, experiments, CANDIDATES, generator)
            few = [self._searched(one, experiments, 1) for one in drawn]
            if few:
                carried_on = self._searched(min(few, key=_misfit).model, experiments, self.rounds)
                best = min(best, carried_on, key=_misfit)
        return best

    def _with_prior(self, prior: Model, experiments: Sequence[FrequencyResponse]) -> Estimate:
        if any(data.variance is None for data in experiments):
            raise MisuseError("a prior estimate is weighed against responses of known variances; state them", "data")
        values, vectors = np.linalg.eigh(prior.theta_covariance)
        known = values > KNOWN * values[-1]
        weight = (vectors[:, known] / np.sqrt(values[known])).T
        whiteners = [whitener(data) for data in experiments]
        chart = charted(prior).chart
        assert chart is not None, "state spaces have one"

        def evaluate(delta: FloatArray) -> tuple[FloatArray, FloatArray]:
            residual, full = residual_and_jacobian(_moved(prior, chart @ delta), experiments, whiteners)
            change = weight @ chart
            return np.concatenate([residual, change @ delta]), np.concatenate([full @ chart, change])

        begun = np.zeros(chart.shape[1])
        solution = levenberg_marquardt(evaluate, begun, None, self.rounds * self.max_iterations, PRECISION)
        inflation = max(variance_inflation(data.variance_degrees_of_freedom) for data in experiments)
        freedom = len(solution.residual) - len(begun)
        test = chi_square("lack of fit beside the prior estimate", solution.cost, freedom)
        model = _moved(prior, chart @ solution.x)
        covariance = inflation * chart @ solution.covariance @ chart.T
        found = charted(replace(model, covariance=covariance))
        return Estimate(found, solution.outcome, (test,))

    def _searched(self, start: Model, experiments: Sequence[FrequencyResponse], rounds: int) -> Estimate:
        """What a search of so many rounds reaches from a start."""
        model, whiteners = start, [whitener(data) for data in experiments]
        iterations, cost = 0, np.inf
        for _ in range(rounds):
            solution, chart = self._round(model, experiments, whiteners)
            model, iterations = _moved(model, chart @ solution.x), iterations + solution.outcome.iterations
            if solution.outcome.ok or solution.cost > cost * (1 - PRECISION**2):
                break
            cost = solution.cost
        return _estimate(model, chart, solution, experiments, iterations)

    def _round(
        self,
        model: Model,
        experiments: Sequence[FrequencyResponse],
        whiteners: Sequence[ComplexArray],
    ) -> tuple[LeastSquaresSolution, FloatArray]:
        """A search in the coordinates δ of θ + chart δ."""
        jacobian = residual_and_jacobian(model, experiments, whiteners)[1]
        chart = _chart(jacobian)

        def evaluate(delta: FloatArray) -> tuple[FloatArray, FloatArray]:
            residual, full = residual_and_jacobian(_moved(model, chart @ delta), experiments, whiteners)
            return residual, full @ chart

        def feasible(delta: FloatArray) -> bool:
            return self._inside(_moved(model, chart @ delta))

        start = np.zeros(chart.shape[1])
        inside = feasible if self.region is not None else None
        return levenberg_marquardt(evaluate, start, inside, self.max_iterations, PRECISION), chart

    def _inside(self, model: Model) -> bool:
        count = len(model.variables)
        points = grid(model.variables, 65) if count == 1 else fine_grid(model.variables)
        return self.region is None or bool(np.all(self.region.excess(model.poles(points)) < -self.margin))

    def _check(self, start: Model, experiments: Sequence[FrequencyResponse]) -> None:
        structure = start.structure
        ours = (structure.sample_time, (structure.outputs, structure.inputs))
        for data in experiments:
            theirs = (data.sample_time, data.matrices.shape[1:])
            if ours != theirs:
                raise MisuseError(
                    f"sample time and outputs × inputs are {ours} in the start and {theirs} in the data at"
                    f" {data.operating_point}; they must agree",
                    "start",
                )
        freedom = _freedom(start, experiments)
        if freedom < 0:
            raise NotIdentifiableError(
                f"the responses hold {-freedom} real numbers fewer than the model has free parameters; measure more"
                " lines or operating points, or choose a lower order",
                "frequencies",
            )
        if not self._inside(start):
            raise MisuseError(
                "poles of the start lie outside the region, or closer to its edge than the margin; start from a model"
                " estimated with this region",
                "start",
            )

    @classmethod
    def example(cls) -> "StateSpaceLikelihood":
        """A small one, for the conformance tests."""
        return cls()


def _fits(found: Estimate) -> bool:
    """Whether the noise explains what is left, where its size is known; more starts would tell nothing elsewhere."""
    return not found.tests or found.tests[0].p_value > ACCEPTED_FIT


def _misfit(found: Estimate) -> float:
    return found.tests[0].statistic


def _chart(jacobian: FloatArray) -> FloatArray:
    """The directions of θ (k, r) that change the residual, from its Jacobian (R, k), each changing it by one."""
    norms = np.linalg.norm(jacobian, axis=0)
    scale = 1 / np.maximum(norms, 1e-12 * norms.max())
    _, sizes, directions = np.linalg.svd(triangular_factor(jacobian * scale))
    kept = sizes > EFFECTIVE * sizes[0]
    return np.asarray(scale[:, None] * (directions[: len(sizes)][kept] / sizes[kept, None]).T)


def _moved(model: Model, change: FloatArray) -> Model:
    return replace(model, theta=model.theta + change)


def _undetermined(model: Model, experiments: Sequence[FrequencyResponse]) -> bool:
    """Whether θ can change so that the responses stay as they are where measured, but not elsewhere in the range."""
    omega = experiments[0].frequencies[:: max(len(experiments[0]) // 40, 1)]
    places = grid(model.variables, 9 if len(model.variables) == 1 else 4)
    elsewhere = _real(np.concatenate([entry_gradient(model, tuple(p), omega) for p in places]))
    measured = _real(np.concatenate([entry_gradient(model, d.operating_point, d.frequencies) for d in experiments]))
    return _rank(np.concatenate([measured, elsewhere])) > _rank(measured)


def _real(gradient: ComplexArray) -> FloatArray:
    flat = gradient.reshape(-1, gradient.shape[-1])
    return np.concatenate([flat.real, flat.imag])


def _rank(jacobian: FloatArray) -> int:
    return len(_chart(jacobian).T)


def _freedom(model: Model, experiments: Sequence[FrequencyResponse]) -> int:
    size = len(model.theta) - model.structure.order**2
    count: int = sum(real_count(data) * _entries(data) for data in experiments)
    return count - size


def _entries(data: FrequencyResponse) -> int:
    return int(data.output_count * data.input_count)


def _estimate(
    model: Model,
    chart: FloatArray,
    solution: LeastSquaresSolution,
    experiments: Sequence[FrequencyResponse],
    iterations: int,
) -> Estimate:
    freedom = _freedom(model, experiments)
    stated = all(data.variance is not None for data in experiments)
    inflation = max(variance_inflation(data.variance_degrees_of_freedom) for data in experiments)
    variance = 1.0 if stated or not freedom else solution.cost / freedom
    covariance = inflation * variance * chart @ solution.covariance @ chart.T
    exact = stated and all(data.variance_degrees_of_freedom is None for data in experiments)
    tests = (chi_square("lack of fit", solution.cost, freedom),) if exact and freedom else ()
    outcome = Outcome(solution.outcome.status, solution.outcome.advice, iterations)
    if _undetermined(model, experiments):
        advice = "the data do not determine the model between the operating points; measure at more of them"
        outcome = Outcome("not_identifiable", advice, iterations)
    found = charted(replace(model, covariance=covariance, noise_variance=variance))
    return Estimate(found, outcome, tests)
