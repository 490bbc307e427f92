"""Maximum likelihood of a rational model on a frequency response."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.estimates import LocalEstimate
from identification.least_squares import LeastSquaresSolution, levenberg_marquardt
from identification.lti.delay_search import aliases, coherent_delays, shortest
from identification.lti.likelihood import require_same_sampling, response_errors
from identification.lti.rational_basis import LinearProblem, frequency_scale, rescale
from identification.lti.rational_start import linear_starts
from identification.lti.relaxation import relaxation_fit, require_relaxation
from identification.lti.response_tests import lack_of_fit, neighbour_correlation, real_count, variance_inflation
from identification.models.model import LocalModel
from identification.models.physical import RationalForm
from identification.models.rational import RationalStructure
from identification.outcome import Outcome
from identification.signals import FrequencyResponse

LINES_FOR_DELAY = 400
OTHERS = 4
REBUILT, SETTLED = 20, 1e-3

Weighting = Literal["variance", "relative", "absolute"]


@dataclass(frozen=True)
class RationalFit:
    """Fits B/A, with or without delay, to a frequency response in discrete or continuous time.

        min Σ_k |Ĝ_k − G(ω_k; ζ)|² / σ_k²                         [PintelonSchoukens2012, Chapter 9]

    `weighting` "variance" takes σ_k² from the data: the estimate is the most likely one, its covariance (JᵀJ)⁻¹ is
    exact to first order for known variances and inflated by d/(d − 2) for variances estimated with d degrees of
    freedom. Where the input has errors (`input_errors`) it is that of errors in both signals, Ĝ_k and σ_k rebuilt under
    each solution until that moves by no more than a thousandth of its deviation. "relative" takes σ_k = |Ĝ_k|,
    "absolute" σ_k = 1; their covariance uses the variances of the data where there are any, and else the scale
    s² = Σ|Ĝ_k − G|²/σ_k² · 2/(2F − n).

    `noise_variance` of the model is the factor on the assumed σ_k²: 1 for "variance", else s², the relative or the
    absolute variance of the noise. With `stable` the poles stay in the stable region; a rigid body or an
    integrator needs `stable=False`. With `relaxation` all poles are real with positive residues, as of resistors and
    RC arcs in series; an order too low for the data then cannot be bent into something else.
    """

    kind: ClassVar[str] = "rational_fit"
    data: ClassVar[type] = FrequencyResponse

    weighting: Annotated[Weighting, "what the errors are divided by: stated variance, response or nothing"] = "variance"
    stable: Annotated[bool, "keep all poles in the stable region"] = True
    relaxation: Annotated[bool, "real poles with positive residues: resistors and RC arcs in series"] = False
    max_iterations: Annotated[int, "most iterations of each search"] = 200

    @classmethod
    def example(cls) -> "RationalFit":
        """An instance for tests and catalogues."""
        return cls(weighting="relative")

    def estimate(self, structure: RationalForm, data: FrequencyResponse) -> LocalEstimate:
        """The fit of `structure`, with tests of its residual.

        `fit_percent` is 100 (1 − ‖Ĝ − G‖/‖Ĝ − mean Ĝ‖) (‖Ĝ‖ for a constant Ĝ). Raises MisuseError for a structure with
        a noise model or of another time domain, and where the weighting asked for is not there; NotIdentifiableError
        for fewer real numbers than unknowns. A search that fails says so in `outcome`.
        """
        self._check(structure, data)
        inflation = variance_inflation(data.variance_degrees_of_freedom) if self.weighting == "variance" else 1.0
        plain = structure.plain
        scaled = replace(plain, frequency_scale=frequency_scale(plain, data))
        weights = self._weights(data)
        solution = self._search(scaled, data, weights)
        if self.weighting == "variance" and data.input_errors is not None:
            data, weights, solution = self._with_input_errors(scaled, data, weights, solution)
        factors = rescale(scaled, structure.frequency_scale)
        free = real_count(data) - structure.size
        scale = 1.0 if self.weighting == "variance" else solution.cost / free
        covariance = inflation * self._covariance(solution, data, weights, scale) * np.outer(factors, factors)
        zeta = structure.of_plain(factors * solution.x)
        covariance = structure.covariance_of_plain(zeta, covariance)
        model = LocalModel(structure, data.operating_point, zeta, covariance, scale)
        errors = (solution.residual[: len(data)] + 1j * solution.residual[len(data) :]) / np.sqrt(2)
        whitened = np.ones(len(data)) if data.variance is None else 1 / (weights * np.sqrt(data.variance))
        tests = [neighbour_correlation(data, errors, solution.jacobian, whitened)]
        if self.weighting == "variance" and free:
            tests.insert(0, lack_of_fit(data, errors, structure.size))
        outcome = _with_advice(solution.outcome, scaled, solution.x, self.stable, free)
        if structure.delay:
            outcome = self._with_delay_advice(outcome, scaled, solution, data, weights)
        return LocalEstimate(model, outcome, tuple(tests), _fit_percent(data, errors / weights))

    def _check(self, structure: RationalForm, data: FrequencyResponse) -> None:
        require_same_sampling(structure, data)
        if self.relaxation:
            require_relaxation(structure.plain)
            if data.held is not None:
                raise MisuseError(
                    "positive residues are fitted to responses of continuous inputs, not of held ones; leave the"
                    " relaxation out",
                    "relaxation",
                )
        if structure.n_noise:
            raise MisuseError(
                "a frequency response says nothing about the noise model; set n_c and n_d to zero", "structure"
            )
        if real_count(data) < structure.size + (self.weighting != "variance"):
            also = "" if self.weighting == "variance" else " and the noise"
            raise NotIdentifiableError(
                f"{len(data)} frequencies hold {real_count(data)} real numbers for {structure.size} coefficients{also};"
                " measure more frequencies or choose a lower order",
                "frequencies",
            )
        if not np.any(data.response):
            raise RangeError("the response is zero at every frequency; check the measurement", "response")

    def _weights(self, data: FrequencyResponse) -> FloatArray:
        if self.weighting == "absolute":
            return np.ones(len(data))
        if self.weighting == "relative":
            if not np.all(data.response):
                raise RangeError(
                    "the response is zero at a frequency; remove that frequency or use the weighting 'absolute'",
                    "response",
                )
            return np.asarray(1 / abs(data.response))
        if data.variance is None:
            raise MisuseError(
                "the frequency response carries no variance; give one or use the weighting 'relative' or 'absolute'",
                "weighting",
            )
        return np.asarray(1 / np.sqrt(data.variance))

    def _search(self, scaled: RationalStructure, data: FrequencyResponse, weights: FloatArray) -> LeastSquaresSolution:
        if self.relaxation:
            return relaxation_fit(scaled, data, weights, self.max_iterations)
        if scaled.delay:
            kept = np.unique(np.linspace(0, len(data) - 1, min(len(data), LINES_FOR_DELAY)).round().astype(np.int64))
            few = replace(
                data, frequencies=data.frequencies[kept], response=data.response[kept], variance=None, input_errors=None
            )
            rough = self._searches(scaled, few, weights[kept], self._starts(scaled, few, weights[kept], 24), 40)
            starts = np.stack([solution.x for solution in sorted(rough, key=lambda s: s.cost)[:3]])
        else:
            starts = self._starts(scaled, data, weights, 3)
        best = min(self._searches(scaled, data, weights, starts, self.max_iterations), key=lambda s: s.cost)
        if scaled.delay:
            best.x[-1] = shortest(best.x[-1], data.frequencies)
        return best

    def _with_input_errors(
        self,
        scaled: RationalStructure,
        data: FrequencyResponse,
        weights: FloatArray,
        solution: LeastSquaresSolution,
    ) -> tuple[FrequencyResponse, FloatArray, LeastSquaresSolution]:
        """Data, weights and solution that agree: the data are rebuilt under each solution until it stays."""
        given, before = data, solution.x
        for _ in range(REBUILT):
            data = given.under(scaled.plant_response(before, given.frequencies, given.held))
            weights = self._weights(data)
            if self.relaxation:
                solution = self._search(scaled, data, weights)
            else:
                (solution,) = self._searches(scaled, data, weights, before[None], self.max_iterations)
            moved = np.linalg.norm(solution.jacobian @ (solution.x - before))
            before = solution.x
            if moved < SETTLED:
                break
        return data, weights, solution

    def _with_delay_advice(
        self,
        outcome: Outcome,
        scaled: RationalStructure,
        solution: LeastSquaresSolution,
        data: FrequencyResponse,
        weights: FloatArray,
    ) -> Outcome:
        """The outcome with what else fits alike, or next best, and what a negative delay means."""
        said = [outcome.advice] if outcome.advice else []
        if solution.x[-1] < 0:
            said.append("the delay is negative: the output leads the input; check which signal is which, and the order")
        other = aliases(data.frequencies)
        said.append(other or self._next_best(scaled, solution, data, weights))
        return replace(outcome, advice="; ".join(text for text in said if text))

    def _next_best(
        self, scaled: RationalStructure, solution: LeastSquaresSolution, data: FrequencyResponse, weights: FloatArray
    ) -> str:
        """The best fit with a delay that is another by more than a turn at the highest frequency."""
        turns = data.response[1:] * data.response[:-1].conj()
        starts = np.tile(solution.x, (OTHERS, 1))
        starts[:, -1] = np.resize(coherent_delays(data.frequencies, turns, OTHERS), OTHERS)
        apart = abs(starts[:, -1] - solution.x[-1]) > 2 * np.pi / data.frequencies.max()
        found = self._searches(scaled, data, weights, starts[apart], 40)
        others = [one for one in found if abs(one.x[-1] - solution.x[-1]) > np.pi / data.frequencies.max()]
        if not others:
            return ""
        best = min(others, key=lambda one: one.cost)
        more = best.cost - solution.cost
        return f"the next best delay is {best.x[-1]:.6g} s, with a sum of squares that is larger by {more:.4g}"

    def _starts(
        self, scaled: RationalStructure, data: FrequencyResponse, weights: FloatArray, count: int
    ) -> FloatArray:
        starts = linear_starts(LinearProblem.of(scaled, data, weights), self.stable, count=count)
        if len(starts.cost) == 0:
            raise NotIdentifiableError("no model of this order could be started from; choose a lower order", "n_a")
        return starts.zeta

    def _searches(
        self,
        scaled: RationalStructure,
        data: FrequencyResponse,
        weights: FloatArray,
        starts: FloatArray,
        iterations: int,
    ) -> list[LeastSquaresSolution]:
        def evaluate(zeta: FloatArray) -> tuple[FloatArray, FloatArray]:
            return response_errors(scaled, zeta, data, weights)

        def feasible(zeta: FloatArray) -> bool:
            return not self.stable or bool(scaled.stable(zeta))

        return [levenberg_marquardt(evaluate, start, feasible, iterations) for start in starts]

    def _covariance(
        self, solution: LeastSquaresSolution, data: FrequencyResponse, weights: FloatArray, scale: float
    ) -> FloatArray:
        """(JᵀJ)⁻¹, scaled, or with known variances (JᵀJ)⁻¹ Jᵀ Σ J (JᵀJ)⁻¹ for weights that are not theirs."""
        inverse = solution.covariance
        if self.weighting == "variance" or data.variance is None or not np.all(np.isfinite(inverse)):
            return inverse * scale
        true = np.tile(weights * np.sqrt(data.variance), 2)[:, None] * solution.jacobian @ inverse
        return np.asarray(true.T @ true)


def relative_error(model: LocalModel, data: FrequencyResponse, weighting: Weighting = "relative") -> float:
    """How far a model is from a frequency response, as a fraction of the response.

        "relative":  √(1/F Σ_k |(Ĝ_k − G_k)/Ĝ_k|²)   (every line counts the same)
        "absolute":  ‖Ĝ − G‖ / ‖Ĝ‖
        "variance":  √(Σ|Ĝ_k − G_k|²/σ_k² / Σ|Ĝ_k|²/σ_k²)

    Raises MisuseError where the variance, or a response other than zero, is missing.
    """
    require_same_sampling(model.structure, data)
    weights = RationalFit(weighting=weighting)._weights(data)
    error = data.response - model.structure.plant_response(model.zeta, data.frequencies, data.held)
    return float(np.linalg.norm(weights * error) / np.linalg.norm(weights * data.response))


def _fit_percent(data: FrequencyResponse, errors: FloatArray) -> float:
    spread = np.linalg.norm(data.response - data.response.mean())
    whole = np.linalg.norm(data.response)
    return float(100 * (1 - np.linalg.norm(errors) / (spread if spread > 1e-12 * whole else whole)))


def _with_advice(outcome: Outcome, structure: RationalStructure, zeta: FloatArray, stable: bool, free: int) -> Outcome:
    """The outcome with what to try: no stability region for poles at its border, more lines for an exact fit."""
    poles = structure.poles(zeta)
    margin = 1 - abs(poles) if structure.is_discrete else -poles.real / np.maximum(abs(poles), 1e-300)
    if not outcome.ok and stable and np.any(margin < 1e-6):
        advice = f"{outcome.advice}; a pole lies at the border of stability: allow unstable models (stable=False)"
        return replace(outcome, advice=advice)
    if outcome.ok and free == 0:
        return replace(outcome, advice="there are no more data than coefficients, so the noise cannot be judged")
    return outcome
