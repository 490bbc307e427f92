"""Prediction error identification of one operating point."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.estimates import LocalEstimate
from identification.least_squares import LeastSquaresSolution, levenberg_marquardt
from identification.lti.box_jenkins_start import waves
from identification.lti.free_noise import RecordInLoop, errors_in_loop, turned_out, with_nuisance
from identification.lti.initial_conditions import (
    InitialConditions,
    errors_from,
    errors_only,
    fitted_record,
    free_parameters,
    simulated_output,
)
from identification.lti.likelihood import delayed, require_same_sampling
from identification.lti.multistart import lowest_minimum
from identification.lti.whiteness import input_independence, whiteness
from identification.measurements.loop_delay import require_delay
from identification.models.model import LocalModel
from identification.models.rational import RationalStructure
from identification.outcome import Outcome, TestResult
from identification.signals import TimeRecord
from identification.spectral.resolution import require_changing

LARGEST = 1e60
CLEARLY = 10.0


@dataclass(frozen=True)
class PredictionError:
    """Prediction error estimate of the Box–Jenkins family from a time record [Ghosh2018, (6)], in discrete time.

        ζ̂ = arg min Σ_t ε²(t, ζ),   ε = H⁻¹(q, ζ) (y − G(q, ζ) u)
        σ̂_e² = Σ ε² / (N − n − n_x),   P_ζ = σ̂_e² (JᵀJ)⁻¹,   J = ∂ε/∂ζ        (the sample version of (7) and (8))

    u and y are taken about the levels of the record, stated or not. n_x values are estimated along with ζ and
    marginalised when `initial_conditions` is "estimate": the initial state (max(n_a, n_b), the first n_k samples of
    the output being left out) and, where it was not stated, the level of the output; with "zero" the plant starts from
    rest, n_x = 0, and only stated levels are taken off. The noise model starts from rest in both cases.
    The search starts from linear estimates, see `identification.lti.box_jenkins_start`, and stays among stable models.
    σ̂_e² does not fall below the rounding of the output. A record with feedback, where the structure has no H, gets a
    noise model that is as rich as the data ask for and no part of ζ (`identification.lti.free_noise`); without it the
    estimate is biased. An unstable plant is taken where it is clearly more likely. `noise_variance` of the model is
    then that of the disturbance. A plant that answers without delay in a loop that may do so too is refused
    (`require_delay`).
    """

    kind: ClassVar[str] = "prediction_error"
    data: ClassVar[type] = TimeRecord

    initial_conditions: Annotated[
        InitialConditions, "whether the plant starts from rest (zero) or from an unknown state (estimate)"
    ] = "estimate"

    def __post_init__(self) -> None:
        if self.initial_conditions not in ("zero", "estimate"):
            raise MisuseError('choose "zero" or "estimate"', "initial_conditions")

    def estimate(self, structure: RationalStructure, record: TimeRecord) -> LocalEstimate:
        """The model of one record with its covariance, tests of its prediction errors and fit.

        An input that does not excite all parameters gives the outcome "not_identifiable" and infinite variances.
        Raises MisuseError when structure and record do not fit each other, and NotIdentifiableError when the record is
        shorter than the number of unknowns, or its input or output is zero throughout (RangeError: beyond 1e±60).
        """
        require_changing(record)
        require_same_sampling(structure, record)
        require_delay(structure, record)
        full = structure
        structure, record = fitted_record(full, record, self.initial_conditions)
        free = free_parameters(structure, self.initial_conditions, record)
        _require_information(structure, record, free)
        scales = _rms(record.input), _rms(record.output)
        scaled = replace(record, input=record.input / scales[0], output=record.output / scales[1])
        excited = _excited_directions(structure, scaled, self.initial_conditions)
        solution = self._search(structure, scaled, sufficient=excited == structure.n_plant)
        units = np.ones(structure.size)
        units[structure.n_a : structure.n_plant] = scales[1] / scales[0]
        variance = max(solution.cost / (len(record) - structure.size - free), float(np.finfo(float).eps) ** 2)
        outcome = _outcome(structure, solution, excited)
        covariance = variance * solution.covariance * np.outer(units, units)
        if outcome.status == "not_identifiable":
            covariance = np.full_like(covariance, np.inf)
        tests = _tests(solution, variance, structure, scaled)
        if isinstance(scaled, RecordInLoop):
            variance = float(np.mean(errors_in_loop(structure, solution.x, scaled).disturbance ** 2))
        model = LocalModel(full, record.operating_point, solution.x * units, covariance, variance * scales[1] ** 2)
        return LocalEstimate(model, outcome, tests, self._fit(structure, model.zeta, record))

    def _search(self, structure: RationalStructure, record: TimeRecord, sufficient: bool) -> LeastSquaresSolution:
        first_estimates = waves(structure, record)
        waves_tried = first_estimates if sufficient else [next(first_estimates)[:1]]

        def evaluate(zeta: FloatArray) -> tuple[FloatArray, FloatArray]:
            return errors_from(structure, zeta, record, self.initial_conditions)

        found = lowest_minimum(
            evaluate,
            lambda zeta: errors_only(structure, zeta, record, self.initial_conditions),
            lambda zeta: bool(structure.stable(zeta)),
            waves_tried,
        )
        if not isinstance(record, RecordInLoop) or structure.n_a == 0:
            return found
        beyond = levenberg_marquardt(evaluate, turned_out(structure, found.x), tolerance=1e-7)
        clearly = len(record) * np.log(found.cost / beyond.cost) > CLEARLY
        return beyond if beyond.outcome.ok and clearly else found

    def _fit(self, structure: RationalStructure, zeta: FloatArray, record: TimeRecord) -> float:
        simulated = simulated_output(structure, zeta, record, self.initial_conditions)
        spread = np.linalg.norm(record.output - record.output.mean()) or np.linalg.norm(record.output)
        return float(100 * (1 - np.linalg.norm(record.output - simulated) / spread))

    @classmethod
    def example(cls) -> "PredictionError":
        """A small one, for the conformance tests."""
        return cls()


def _require_information(structure: RationalStructure, record: TimeRecord, free: int) -> None:
    unknowns = structure.size + free
    if len(record) <= unknowns + 1:
        raise NotIdentifiableError(
            f"{len(record)} samples cannot determine {unknowns} unknowns and their accuracy; record longer or choose"
            " lower orders",
            "input",
        )
    for name, signal in (("input", record.input), ("output", record.output)):
        if not np.any(signal):
            raise NotIdentifiableError(
                f"the {name} stays at one value, nothing can be learnt from it; check the channel, excite the plant, or"
                " state the operating levels if that value is the excitation",
                name,
            )
        if not LARGEST**-1 < float(np.abs(signal).max()) < LARGEST:
            raise RangeError(f"the {name} is too large or too small to be computed with; choose another unit", name)


def _excited_directions(structure: RationalStructure, record: TimeRecord, initial: InitialConditions) -> int:
    """The rank of (u(t), …, u(t − n_a − n_b)): how many coefficients of G the input tells apart [Ljung1999, 13.2].

    Before a record that starts from rest the input was zero; otherwise only what is within the record counts, and
    where the levels were not stated only what is not constant.
    """
    past = delayed(record.input, structure.n_k, structure.n_plant)
    if initial == "estimate":
        past = past[structure.n_plant - 1 :]
        past = past if record.level_known else past - past.mean(axis=0)
    values = np.linalg.svd(np.linalg.qr(past, mode="r"), compute_uv=False)
    return int(np.sum(values > 1e-9 * values.max(initial=np.finfo(float).tiny)))


def _outcome(structure: RationalStructure, solution: LeastSquaresSolution, excited: int) -> Outcome:
    if excited < structure.n_plant:
        advice = (
            f"the input tells only {excited} of the {structure.n_plant} coefficients of G apart; excite more"
            " frequencies, choose lower orders, or estimate jointly with other operating points"
        )
        return Outcome("not_identifiable", advice, solution.outcome.iterations)
    if structure.n_noise and solution.cost <= 1e-26 * len(solution.residual):
        advice = "the record holds no noise from which H could be learnt; leave C and D out (n_c = n_d = 0)"
        return Outcome("not_identifiable", advice, solution.outcome.iterations)
    return solution.outcome


def _tests(
    solution: LeastSquaresSolution, variance: float, structure: RationalStructure, record: TimeRecord
) -> tuple[TestResult, ...]:
    jacobian, taken = with_nuisance(structure, solution.x, record, solution.jacobian)
    covariance = variance * solution.covariance
    found = (
        whiteness(structure, solution.x, covariance, solution.residual, taken=taken),
        input_independence(structure, solution.residual, jacobian, record.input),
    )
    return tuple(test for test in found if test is not None)


def _rms(signal: FloatArray) -> float:
    peak = float(np.abs(signal).max())
    return peak * float(np.sqrt(np.mean((signal / peak) ** 2)))
