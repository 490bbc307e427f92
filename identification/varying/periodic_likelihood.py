"""Maximum likelihood of a state-space model from synchronised periodic data, in the frequency domain."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.estimates import Estimate
from identification.least_squares import LeastSquaresSolution, levenberg_marquardt
from identification.lti.response_tests import variance_inflation
from identification.models.model import Model
from identification.models.state_space import Matrices
from identification.outcome import Outcome
from identification.scheduling import ProductBasis
from identification.varying.input_affine_start import input_affine_start
from identification.varying.periodic_residuals import PeriodicResiduals, lack_of_fit
from identification.varying.perturbed_starts import perturbed_starts, stabilised
from identification.varying.progress import Progress, Steps, silent, within
from identification.varying.records import TOLERANCE, VaryingRecord, steady_periods
from identification.varying.scheduled import Scheduled
from identification.varying.stacks import balanced, stated_order

CHARTS = 20
STEPS_IN_A_CHART = 15
CANDIDATES = 40
ACCEPTED_FIT = 1e-4
ROUNDING = 1e-2  # of the cost expected: what is left of noise-free data
BAD_FIT = "the model fits worse than the noise allows; choose a higher order, give another start or drop more periods"


@dataclass(frozen=True)
class PeriodicLikelihood:
    """Maximum likelihood of A_i, B_i, C_i, D_i from a record with periodic, synchronised input and scheduling.

        θ̂ = arg min (Y(θ) − Ȳ)* C_e⁻¹ (Y(θ) − Ȳ)      [Goos2014, (27)]

    Assumes noise on the output only, white or coloured, and a steady state. Ȳ is the spectrum of the mean period, C_e
    the noise covariance from the lines between the harmonics. All matrices are free; each search runs in a chart
    θ = θ_c + Q δ perpendicular to the changes of the state basis, and the chart is renewed until nothing is gained.
    The model is stable over a scheduling period. P_θ is the Cramér–Rao bound ν/(ν − 2) Q (QᵀJᵀJQ)⁻¹ Qᵀ, corrected for
    the ν degrees of freedom of the noise estimate. Without a `start` it begins at the best linear time-invariant
    approximation with the extended input [Goos2014, Section 3.3]; where the fit is then worse than the noise allows,
    models around it are tried too.
    """

    kind: ClassVar[str] = "periodic_likelihood"

    drop_periods: Annotated[
        int | None, "leading periods left out as transient; found from the record when not given"
    ] = None
    tolerance: Annotated[float, "largest repetition error of input and scheduling, relative to their variation"] = (
        TOLERANCE
    )
    zero_frequency: Annotated[bool, "use the line at zero frequency (the output has no offset)"] = True
    more_starts: Annotated[int, "how often more first models are drawn while the fit is bad"] = 3
    seed: Annotated[int, "of the generator that draws them"] = 0
    max_charts: Annotated[int, "how often the chart of parameters is renewed at most"] = CHARTS

    def __post_init__(self) -> None:
        if self.drop_periods is not None and self.drop_periods < 0:
            raise RangeError(f"drop_periods is {self.drop_periods}; it must be zero or more", "drop_periods")
        if self.max_charts < 1:
            raise RangeError(f"max_charts is {self.max_charts}; it must be one or more", "max_charts")

    def estimate(
        self,
        record: VaryingRecord,
        order: int | None,
        start: Model | None = None,
        *,
        basis: ProductBasis | None = None,
        progress: Progress = silent,
    ) -> Estimate:
        """The model of order n_x of a record over the functions of a basis (1, p_1, p_2, …), with its covariance.

        Raises MisuseError when the record is not periodic, not synchronised or too short (see `steady_periods`),
        NotIdentifiableError when its lines cannot determine so many parameters, ShapeError when the start does not fit,
        and as `Scheduled.of`. Excitation of too low a rank gives the outcome "not_identifiable" and no covariance.
        """
        order, steady = stated_order(order), steady_periods(record, self.drop_periods, self.tolerance)
        scheduled = Scheduled.of(record, basis, start)
        residuals = PeriodicResiduals.of(steady, scheduled.at(steady.scheduling), order, self.zero_frequency)
        _require_enough(residuals)
        starts = _starts(residuals) if start is None else [scheduled.matrices(start, order)]
        solution, chart = self._search(residuals, starts, progress)
        matrices = residuals.blocks.sizes.split(solution.x)
        if solution.outcome.status == "not_identifiable":
            return Estimate(scheduled.model(matrices), solution.outcome, ())
        inflation = variance_inflation(residuals.noise.degrees_of_freedom)
        covariance = inflation * chart @ replace(solution, jacobian=solution.jacobian @ chart).covariance @ chart.T
        fit = lack_of_fit(residuals, solution)
        outcome = solution.outcome
        if outcome.ok and fit.p_value < ACCEPTED_FIT:
            outcome = replace(outcome, advice=BAD_FIT)
        return Estimate(scheduled.model(matrices, covariance, residuals.noise_variance), outcome, (fit,))

    @classmethod
    def example(cls) -> "PeriodicLikelihood":
        """A small one, for the conformance tests."""
        return cls()

    def _search(
        self, residuals: PeriodicResiduals, first: list[Matrices], progress: Progress
    ) -> tuple[LeastSquaresSolution, FloatArray]:
        """The best solution in θ with J (R, size), and its chart Q; more starts are tried while the fit is bad."""
        thetas = [stabilised(residuals.blocks, residuals.blocks.sizes.join(start)) for start in first]
        rounds = self.more_starts + 1
        best = self._lowest(residuals, thetas, None, within(progress, 0.0, 1 / rounds))
        generator = np.random.default_rng(self.seed)
        for i in range(1, rounds):
            if _fits(residuals, best[0]):
                break
            drawn = perturbed_starts(residuals, thetas[0], CANDIDATES, generator)
            best = self._lowest(residuals, drawn, best, within(progress, i / rounds, (i + 1) / rounds))
        return best

    def _lowest(
        self,
        residuals: PeriodicResiduals,
        thetas: list[FloatArray],
        best: tuple[LeastSquaresSolution, FloatArray] | None,
        progress: Progress,
    ) -> tuple[LeastSquaresSolution, FloatArray]:
        for i, theta in enumerate(thetas):
            part = within(progress, i / len(thetas), (i + 1) / len(thetas))
            found = minimised(residuals, theta, self.max_charts, part)
            if best is None or found[0].cost < best[0].cost:
                best = found
            if _fits(residuals, found[0]):
                break
        assert best is not None
        return best


def _fits(residuals: PeriodicResiduals, solution: LeastSquaresSolution) -> bool:
    return lack_of_fit(residuals, solution).p_value > ACCEPTED_FIT


def minimised(
    residuals: PeriodicResiduals, theta: FloatArray, max_charts: int = CHARTS, progress: Progress = silent
) -> tuple[LeastSquaresSolution, FloatArray]:
    """The minimum that a search from θ (size,) reaches, with J (R, size) there, and the last chart Q (size, free)."""
    sizes, iterations = residuals.blocks.sizes, 0
    for i in range(max_charts):
        steps = Steps(within(progress, i / max_charts, (i + 1) / max_charts), f"likelihood, chart {i + 1}")
        theta = sizes.join(balanced(sizes.split(theta)))
        chart, centre = sizes.chart(theta), theta

        def evaluate(
            delta: FloatArray, chart: FloatArray = chart, centre: FloatArray = centre
        ) -> tuple[FloatArray, FloatArray]:
            residual, jacobian = residuals(centre + chart @ delta)
            return residual, jacobian @ chart

        def feasible(delta: FloatArray, chart: FloatArray = chart, centre: FloatArray = centre) -> bool:
            return residuals.blocks.stable(centre + chart @ delta)

        solution = levenberg_marquardt(steps.of(evaluate), np.zeros(chart.shape[1]), feasible, STEPS_IN_A_CHART, 1e-7)
        theta = centre + chart @ solution.x
        iterations += solution.outcome.iterations
        if solution.outcome.ok or solution.outcome.iterations < STEPS_IN_A_CHART:
            break
    jacobian = residuals(theta)[1]
    outcome = Outcome(solution.outcome.status, solution.outcome.advice, iterations)
    if outcome.status == "not_converged" and solution.cost < ROUNDING * len(solution.residual):
        outcome = Outcome("converged", "", iterations)
    return LeastSquaresSolution(theta, solution.residual, jacobian, outcome), sizes.chart(theta)


def _starts(residuals: PeriodicResiduals) -> list[Matrices]:
    """Stacks with A_i = 0, i > 0, from a small and a large number of block rows."""
    found: list[Matrices] = []
    trouble: NotIdentifiableError | None = None
    order = residuals.blocks.sizes.order
    for rows in (order + 2, 2 * order + 4, order + 1):
        try:
            found.append(input_affine_start(residuals.blocks, residuals.measured, residuals.deviation, rows))
        except NotIdentifiableError as error:
            trouble = error
    if not found and trouble is not None:
        raise trouble
    return found


def _require_enough(residuals: PeriodicResiduals) -> None:
    sizes, lines = residuals.blocks.sizes, residuals.blocks.lines
    rows = residuals.blocks.period * sizes.n_outputs
    if rows <= sizes.free:
        raise NotIdentifiableError(
            f"the {len(lines)} lines of the period give {rows} real numbers for {sizes.free} parameters; choose a"
            " longer period or a lower order",
            "period",
        )
    if not abs(residuals.blocks.input).max() > 0:
        raise MisuseError("the input is zero at every sample; check the recording and its channels", "input")
