"""Parameter-varying models from all experiments at once."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError
from identification.estimates import Estimate, LocalEstimate
from identification.least_squares import LeastSquaresSolution, is_singular, levenberg_marquardt
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_residuals import JointResiduals
from identification.lpv.joint_tests import joint_tests
from identification.lpv.pooled_start import pooled_starts, shrunk_zeros
from identification.lpv.stacking import asymptotics_advice, stacked_points
from identification.lti.initial_conditions import InitialConditions, fitted_record
from identification.lti.likelihood import require_same_sampling
from identification.lti.multistart import lowest_minimum
from identification.measurements.loop_delay import require_delay
from identification.models.model import Model
from identification.models.physical import RationalForm
from identification.outcome import Outcome
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse, Measurement, TimeRecord

VARIANCE_ROUNDS = 30
REBUILT, SETTLED = 20, 1e-3


@dataclass(frozen=True)
class JointLikelihood:
    """Maximum likelihood of θ from time records and frequency responses at any operating points, all at once.

        θ̂ = arg min Σ_m ‖r_m(T(p_m) θ)‖² / s_m²,   P_θ = (Σ_m T_mᵀ J_mᵀ J_m T_m / s_m²)⁻¹,   J_m = ∂r_m/∂ζ

    r_m are the prediction errors of a record, s_m² their variance σ_e², or the deviations of a frequency response from
    the model, white with s_m = 1 where its variance is known. Unknown variances are estimated along with θ until both
    agree; σ_e² is common to all records or each record's own, and responses of unknown variance share another one.
    An experiment need not determine a local model of its own: a single line will do, if the others know the rest.
    The model is stable at the operating points of the experiments. The search starts from the generalised least-squares
    estimate of those local estimates that exist, or where these are too few from `identification.lpv.pooled_start`.
    """

    kind: ClassVar[str] = "joint_likelihood"

    initial_conditions: Annotated[
        InitialConditions, "whether the plant starts from rest (zero) or from an unknown state (estimate)"
    ] = "estimate"
    noise_variance: Annotated[
        Literal["common", "per_experiment"], "one noise variance for all records, or one for each"
    ] = "common"
    unknown_variance: Annotated[
        Literal["absolute", "relative"], "whether the errors of responses without a variance are alike or relative"
    ] = "absolute"

    def __post_init__(self) -> None:
        if self.initial_conditions not in ("zero", "estimate"):
            raise MisuseError('choose "zero" or "estimate"', "initial_conditions")
        if self.noise_variance not in ("common", "per_experiment"):
            raise MisuseError('choose "common" or "per_experiment"', "noise_variance")
        if self.unknown_variance not in ("absolute", "relative"):
            raise MisuseError('choose "absolute" or "relative"', "unknown_variance")

    def estimate(
        self,
        structure: RationalForm,
        dependence: ParameterDependence,
        experiments: Sequence[Measurement],
        local: Sequence[LocalEstimate] = (),
        prior: Model | None = None,
    ) -> Estimate:
        """The parameter-varying model of M experiments; local estimates, as many as there are, only help to start.

        `prior`, an estimate from other experiments, adds the rows S (θ − θ̂_1) with P_θ1⁻¹ = SᵀS [Ghosh2018, (13)].
        Raises TooFewOperatingPointsError when the operating points do not determine θ, NotIdentifiableError when too
        few records or samples are given for H or for θ, MisuseError when data and structure do not fit. Data that do
        not determine θ for another reason give the outcome "not_identifiable" and infinite variances.
        """
        for one in experiments:
            if isinstance(one, TimeRecord):
                require_delay(structure.plain, one)
        points = stacked_points(structure, dependence, experiments, prior)
        transfer = dependence.matrix(points)
        _require_information(structure, transfer, experiments, prior)
        residuals = JointResiduals(
            structure,
            transfer,
            tuple(self._fitted(structure, one) for one in experiments),
            prior,
            self.initial_conditions,
            common=self.noise_variance == "common",
            relative=self.unknown_variance == "relative",
        )
        residuals.require_enough()
        about = [one.about_its_level() if isinstance(one, TimeRecord) else one for one in experiments]
        starts = _starts(structure, dependence, about, local, prior, residuals)
        solution, variances = _fit(residuals, starts)
        residuals, solution, variances = _with_input_errors(residuals, solution, variances)
        outcome = _outcome(solution, residuals, variances)
        determined = outcome.status != "not_identifiable"
        covariance = solution.covariance if determined else np.full((dependence.size, dependence.size), np.inf)
        model = Model(structure, dependence, solution.x, covariance, residuals.reported_variance(variances, solution.x))
        tests = joint_tests(residuals, solution) if determined else ()
        return Estimate(model, outcome, tests, tuple(local))

    def _fitted(self, structure: RationalForm, data: Measurement) -> Measurement:
        return (
            fitted_record(structure.plain, data, self.initial_conditions)[1] if isinstance(data, TimeRecord) else data
        )

    @classmethod
    def example(cls) -> "JointLikelihood":
        """A small one, for the conformance tests."""
        return cls()


def _fit(
    residuals: JointResiduals, starts: Iterator[list[FloatArray]]
) -> tuple[LeastSquaresSolution, dict[str, float]]:
    """The solution in white residuals, and the variance of each group of experiments whose variance is unknown."""
    first = next((wave for wave in starts if wave), None)
    if first is None:
        raise NotIdentifiableError(
            "no stable first estimate was found; choose lower orders, or give local estimates", "experiments"
        )
    variances = residuals.group_variances(min(first, key=residuals.cost_of_scales))

    def evaluate(theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        return residuals.white(theta, variances)

    def waves() -> Iterator[list[FloatArray]]:
        yield first
        yield from starts

    solution = lowest_minimum(evaluate, lambda theta: evaluate(theta)[0], residuals.stable, waves())
    for _ in range(VARIANCE_ROUNDS if residuals.groups else 0):
        updated = residuals.updated_variances(solution, variances)
        change = max(abs(updated[group] / variances[group] - 1) for group in variances)
        variances = updated
        iterations = solution.outcome.iterations
        solution = levenberg_marquardt(evaluate, solution.x, residuals.stable, tolerance=1e-7)
        if change < 1e-6:
            break
    else:
        iterations = solution.outcome.iterations
    outcome = Outcome(solution.outcome.status, solution.outcome.advice, iterations)
    return LeastSquaresSolution(solution.x, solution.residual, solution.jacobian, outcome), variances


def _with_input_errors(
    residuals: JointResiduals, solution: LeastSquaresSolution, variances: dict[str, float]
) -> tuple[JointResiduals, LeastSquaresSolution, dict[str, float]]:
    """Responses whose input has errors are rebuilt under each solution until that stays (`FrequencyResponse.under`)."""
    given = residuals.experiments
    if not any(isinstance(one, FrequencyResponse) and one.input_errors is not None for one in given):
        return residuals, solution, variances
    for _ in range(REBUILT):
        before = solution.x
        found = tuple(_under(residuals, m, one, before) for m, one in enumerate(given))
        residuals = replace(residuals, experiments=found)
        solution, variances = _fit(residuals, iter([[before]]))
        if np.linalg.norm(solution.jacobian @ (solution.x - before)) < SETTLED:
            break
    return residuals, solution, variances


def _under(residuals: JointResiduals, m: int, data: Measurement, theta: FloatArray) -> Measurement:
    if not isinstance(data, FrequencyResponse) or data.input_errors is None:
        return data
    zeta = residuals.transfer[m] @ theta
    return data.under(residuals.structure.plant_response(zeta, data.frequencies, data.held))


def _starts(
    structure: RationalForm,
    dependence: ParameterDependence,
    experiments: Sequence[Measurement],
    local: Sequence[LocalEstimate],
    prior: Model | None,
    residuals: JointResiduals,
) -> Iterator[list[FloatArray]]:
    quick = [] if prior is None else [prior.theta]
    usable = [estimate for estimate in local if estimate.outcome.ok and estimate.model.structure == structure]
    by_point = {experiment.operating_point: experiment for experiment in experiments}
    usable = [estimate for estimate in usable if estimate.model.operating_point in by_point]
    try:
        theirs = [_of_kind(structure, by_point[estimate.model.operating_point]) for estimate in usable]
        quick.append(GeneralisedLeastSquares().estimate(structure, dependence, theirs, usable, prior).model.theta)
    except MisuseError:
        pass
    yield [theta for theta in quick if residuals.stable(theta)]
    yield pooled_starts(structure, residuals.transfer, experiments)


def _of_kind(structure: RationalForm, experiment: Measurement) -> Measurement:
    if structure.n_noise and isinstance(experiment, FrequencyResponse):
        raise NotIdentifiableError("a frequency response says nothing about H")
    return experiment


def _require_information(
    structure: RationalForm, transfer: FloatArray, experiments: Sequence[Measurement], prior: Model | None
) -> None:
    for experiment in experiments:
        require_same_sampling(structure, experiment)
    if structure.n_noise == 0 or prior is not None:
        return
    records = [isinstance(experiment, TimeRecord) for experiment in experiments]
    noise = transfer[records][:, structure.n_plant :, :]
    needed = int(np.any(transfer[:, structure.n_plant :, :], axis=(0, 1)).sum())
    if not any(records) or np.linalg.matrix_rank(noise.reshape(-1, noise.shape[-1])) < needed:
        raise NotIdentifiableError(
            f"{sum(records)} time records do not determine H, and frequency responses say nothing about it; leave C and"
            " D out (n_c = n_d = 0) or give time records at more operating points",
            "structure",
        )


def _outcome(solution: LeastSquaresSolution, residuals: JointResiduals, variances: dict[str, float]) -> Outcome:
    """The outcome of the search, unless the experiments leave parameters open for every model alike.

    An initial state fitted to noise can seem to determine what the input does not excite; the settled part of the
    response of a model with fast poles shows it.
    """
    structure = residuals.structure
    if structure.is_discrete:
        inside = shrunk_zeros(structure.plain, residuals.transfer, solution.x, 0.3)
        if is_singular(residuals.settled_jacobian(inside, variances)):
            advice = "the experiments do not determine all parameters; excite more frequencies or choose a lower order"
            return Outcome("not_identifiable", advice, solution.outcome.iterations)
    records = [e for e in residuals.experiments if isinstance(e, TimeRecord)]
    advice = solution.outcome.advice or asymptotics_advice(structure, records)
    return Outcome(solution.outcome.status, advice, solution.outcome.iterations)
