"""State-space models from one experiment with varying scheduling: correlation analysis, then Ho–Kalman."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar, Literal, Protocol

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.estimates import Estimate, Found
from identification.models.state_space import Matrices
from identification.outcome import Outcome
from identification.scheduling import ProductBasis
from identification.varying.correlation_analysis import WhiteExcitation
from identification.varying.correlation_assumptions import (
    broken_assumptions,
    correlation_applies,
    noise_tests,
    signal_tests,
)
from identification.varying.ho_kalman import Realisation, full_realisation, largest_entries, reduced_realisation
from identification.varying.output_error import output_error
from identification.varying.progress import Progress, silent, within
from identification.varying.records import VaryingRecord
from identification.varying.scheduled import Scheduled, Signals
from identification.varying.stacks import StackSizes, simulated
from identification.varying.sub_markov import (
    BasisSelection,
    ExactSubMarkov,
    SubMarkovSource,
    SummedSubMarkov,
    every_word,
)
from identification.varying.sub_markov_least_squares import WordRegression

NOISE_FREE = 1e-5
BEYOND_BOUNDS = 1e100
MOST_WORDS = 3000
MOST_STATES = 10


@dataclass(frozen=True, eq=False, kw_only=True)
class CorrelationFound(Found):
    """What the model stands on.

    `warnings`: those of the assumptions A1–A3 that the data break; `parameters`: how the sub-Markov parameters were
    found; `singular_values` of the Hankel matrix of the last realisation; `rows`, `columns`: the bases selected;
    `corrections`: how many were made; `noise_covariance` Σ_w (n_y, n_y): None, like the covariance of the model,
    without refinement.
    """

    parameters: Literal["correlation", "least_squares"]
    singular_values: FloatArray
    rows: BasisSelection
    columns: BasisSelection
    corrections: int
    noise_covariance: FloatArray | None


class _Fitter(Protocol):
    def fit(self, output: FloatArray) -> SubMarkovSource: ...


@dataclass(frozen=True)
class CorrelationRealisation:
    """Sub-Markov parameters by correlation or least squares, realised by Ho–Kalman [Cox2018, Sections 3 and 4].

        Ĝ = fit(y),   M = realise(Ĝ);   then, with e = y − ŷ_M,   M ← realise(G_M + fit(e))

    The first line is the method of the source. Its error is that of sample correlations: all of y acts as noise on
    each parameter. The corrections, which add what is found in the output error e to the model's own parameters G_M,
    leave e only as that noise; they go on while e decreases. A refinement maximises the likelihood from there.
    """

    kind: ClassVar[str] = "correlation_realisation"

    parameters: Annotated[
        Literal["automatic", "correlation", "least_squares"],
        "how sub-Markov parameters are found; automatic tests whether correlation applies",
    ] = "automatic"
    hankel: Annotated[Literal["reduced", "full"], "whether selected bases or the whole Hankel matrix are realised"] = (
        "reduced"
    )
    rows: Annotated[int, "rows selected by their largest entries"] = 10
    columns: Annotated[int, "columns selected by their largest entries"] = 10
    word_length: Annotated[int, "letters of the longest words from which rows and columns are selected"] = 2
    ridge: Annotated[float, "regularisation of least squares; the corrections undo its bias"] = 0.01
    corrections: Annotated[int, "most corrections by the output error; 0 is the method as published"] = 20
    refinement: Annotated[bool, "whether to maximise the likelihood from there"] = True

    def __post_init__(self) -> None:
        if self.parameters not in ("automatic", "correlation", "least_squares"):
            raise MisuseError('choose "automatic", "correlation" or "least_squares"', "parameters")
        if self.hankel not in ("reduced", "full"):
            raise MisuseError('choose "reduced" or "full"', "hankel")
        least = {"rows": 1, "columns": 1, "word_length": 2 if self.hankel == "full" else 1, "corrections": 0}
        for name, lowest in least.items():
            if getattr(self, name) < lowest:
                raise RangeError(f"{name} is {getattr(self, name)}; it must be at least {lowest}", name)
        if not (np.isfinite(self.ridge) and self.ridge >= 0):
            raise RangeError(f"the ridge is {self.ridge}; it must not be negative", "ridge")

    def estimate(
        self,
        record: VaryingRecord,
        order: int | None = None,
        *,
        basis: ProductBasis | None = None,
        progress: Progress = silent,
    ) -> Estimate:
        """The model of a record over the functions of a basis (1, p_1, p_2, …), with CorrelationFound.

        Without `order` n_x is taken from the singular values.

        With a refinement orders from one up are tried instead, until the information criterion has risen twice:

            BIC = N ln det Σ_w + k ln N,   k free parameters                            [Schwarz1978]

        The record starts from rest, or in any state when refined: then it costs the first model little.
        Input and scheduling may be anything for least squares; correlation needs both white (A2, A3), which is tested.
        Raises NotIdentifiableError when scheduling or input are not rich enough for the words, the record is too short,
        or the order is above the rank of the Hankel matrix; RangeError for an order that is not positive; and as
        `Scheduled.of`.
        """
        if order is not None and order < 1:
            raise RangeError(f"the order is {order}; it must be one or more", "order")
        scheduled = Scheduled.of(record, basis)
        if order is None and self.refinement:
            return self._of_best_order(scheduled, progress)
        return self._of_order(scheduled, order, progress)[0]

    def _of_order(
        self, scheduled: Scheduled, order: int | None, progress: Progress
    ) -> tuple[Estimate, CorrelationFound]:
        record = scheduled.signals
        self._require_few_words(record)
        tests = signal_tests(record.phi, record.input)
        white = self.parameters == "correlation" or (self.parameters == "automatic" and correlation_applies(tests))
        realising = self._by_correlation(record, order) if white else self._by_least_squares(record, order)
        progress(0.1, "realisation of the sub-Markov parameters")
        bases, first = realising.first(record.output, (self.rows, self.columns))
        found, corrections = realising.corrected(first, bases, record, self.corrections, within(progress, 0.2, 0.5))
        matrices, outcome = found.matrices, Outcome("converged", "", corrections)
        errors, covariance, noise, variance = _errors(matrices, record), None, None, 1.0
        if self.refinement and np.all(np.isfinite(errors)):
            refined = output_error(matrices, record, progress=within(progress, 0.5, 1.0))
            matrices, outcome, errors = refined.matrices, refined.outcome, refined.errors
            covariance, noise, variance = refined.covariance, refined.noise_covariance, refined.noise_variance
        if not np.linalg.norm(errors) < np.linalg.norm(record.output):
            advice = (
                "the model explains nothing of the output; choose another order, allow corrections or record longer"
            )
            outcome = Outcome("not_converged", advice, outcome.iterations)
        elif (self.refinement or corrections) and np.linalg.norm(errors) > NOISE_FREE * np.linalg.norm(record.output):
            tests = (*tests, *noise_tests(errors))
        beside = CorrelationFound(
            warnings=broken_assumptions(tests, white),
            parameters="correlation" if white else "least_squares",
            singular_values=found.singular_values,
            rows=bases[0],
            columns=bases[1],
            corrections=corrections,
            noise_covariance=noise,
        )
        return Estimate(scheduled.model(matrices, covariance, variance), outcome, tests, found=beside), beside

    def _of_best_order(self, scheduled: Scheduled, progress: Progress) -> Estimate:
        most = MOST_STATES if self.hankel == "full" else max(min(self.rows, self.columns) // 2, 1)
        best: tuple[float, Estimate] | None = None
        for n in range(1, most + 1):
            try:
                found, beside = self._of_order(scheduled, n, within(progress, (n - 1) / most, n / most))
            except NotIdentifiableError:
                if best is None:
                    raise
                break
            score = _information(beside, found.model.structure.order, scheduled.signals)
            if best is None or score < best[0]:
                best = (score, found)
            if n >= best[1].model.structure.order + 2 or _noise_free(beside, scheduled.signals):
                break
        assert best is not None, "the first order gives a model or raises"
        advice = f"order {best[1].model.structure.order} was chosen among 1 to {n}. {best[1].outcome.advice}".strip()
        return replace(best[1], outcome=replace(best[1].outcome, advice=advice))

    def _require_few_words(self, record: Signals) -> None:
        k = record.phi.shape[1]
        most = max(record.input.shape[1], record.output.shape[1]) * sum(
            float(k) ** n for n in range(1, self.word_length + 1)
        )
        if most > MOST_WORDS:
            raise RangeError(
                f"words of up to {self.word_length} letters make {most:.3g} rows or columns of the Hankel matrix, at"
                f" most {MOST_WORDS} are taken; choose shorter words",
                "word_length",
            )

    def _by_correlation(self, record: Signals, order: int | None) -> "_Realising":
        depths = self.word_length, self.word_length
        return _Realising(WhiteExcitation(record.phi, record.input), depths, self.hankel == "full", order)

    def _by_least_squares(self, record: Signals, order: int | None) -> "_Realising":
        longest = _words_within(record, self.word_length)
        full = self.hankel == "full"
        depths = (longest - 2, 2) if full and longest < 4 else ((longest - 1) // 2, longest // 2)
        return _Realising(WordRegression(record.phi, record.input, longest, self.ridge), depths, full, order)

    @classmethod
    def example(cls) -> "CorrelationRealisation":
        """A small one, for the conformance tests."""
        return cls(rows=4, columns=4)


Bases = tuple[BasisSelection, BasisSelection]


@dataclass(frozen=True)
class _Realising:
    """How sub-Markov parameters are fitted and realised; `depths`: letters of the longest rows and columns."""

    fitter: _Fitter
    depths: tuple[int, int]
    full: bool
    order: int | None

    def first(self, output: FloatArray, sizes: tuple[int, int]) -> tuple[Bases, Realisation]:
        """The bases, (n_o, n_r) = `sizes` of them at most, and the realisation of what is found in the output."""
        source = self.fitter.fit(output)
        k, n_y, n_u = source.direct().shape
        rows, columns = every_word(self.depths[0], k, n_y), every_word(self.depths[1], k, n_u)
        if not self.full:
            counts = min(sizes[0], len(rows)), min(sizes[1], len(columns))
            at_rows, at_columns = largest_entries(source.hankel(rows, columns), *counts)
            rows, columns = rows.subset(at_rows), columns.subset(at_columns)
        return (rows, columns), self._realised(source, (rows, columns))

    def corrected(
        self, best: Realisation, bases: Bases, record: Signals, most: int, progress: Progress
    ) -> tuple[Realisation, int]:
        """Corrections while each takes 1 % off the output error; an order that is not given is taken anew."""
        if most == 0:
            return best, 0
        best, errors = _tamed(best, record)
        for count in range(most):
            progress(count / most, f"correction {count + 1}")
            source = SummedSubMarkov(ExactSubMarkov(*best.matrices), self.fitter.fit(errors))
            trial = self._realised(source, bases)
            after = _errors(trial.matrices, record)
            if not np.linalg.norm(after) < 0.99 * np.linalg.norm(errors):
                return best, count
            best, errors = trial, after
        return best, most

    def _realised(self, source: SubMarkovSource, bases: Bases) -> Realisation:
        if self.full:
            return full_realisation(source, self.depths, self.order)
        return reduced_realisation(source, *bases, self.order)


def _tamed(found: Realisation, record: Signals) -> tuple[Realisation, FloatArray]:
    """The realisation, its A_k made smaller while its output error exceeds twice the output; and that error."""
    a, b, c, d = found.matrices
    most = 2 * np.linalg.norm(record.output)
    for shrink in (1.0, 0.9, 0.8, 0.6, 0.4, 0.2):
        tamed = Realisation((shrink * a, b, c, d), found.singular_values)
        errors = _errors(tamed.matrices, record)
        if np.linalg.norm(errors) <= most:
            return tamed, errors
    tamed = Realisation((np.zeros_like(a), b, c, d), found.singular_values)
    return tamed, _errors(tamed.matrices, record)


def _errors(matrices: Matrices, record: Signals) -> FloatArray:
    """y − ŷ (N, n_y), infinite where it has grown beyond all bounds."""
    errors = record.output - simulated(matrices, record.input, record.phi)[1]
    return np.where(abs(errors) < BEYOND_BOUNDS, errors, np.inf)


def _information(found: CorrelationFound, order: int, record: Signals) -> float:
    """BIC; infinite where there is no refined model."""
    if found.noise_covariance is None:
        return np.inf
    size = float(np.linalg.slogdet(found.noise_covariance)[1])
    sizes = StackSizes(order, record.phi.shape[1], record.input.shape[1], record.output.shape[1])
    return len(record) * size + sizes.free * float(np.log(len(record)))


def _noise_free(found: CorrelationFound, record: Signals) -> bool:
    noise = np.inf if found.noise_covariance is None else float(np.trace(found.noise_covariance))
    return noise < NOISE_FREE**2 * float(np.sum(np.mean(record.output**2, axis=0)))


def _words_within(record: Signals, word_length: int) -> int:
    """Letters of the longest words, at most 2 · word_length + 1, with four samples for each regressor."""
    k, n_u = record.phi.shape[1], record.input.shape[1]
    for longest in range(2 * word_length + 1, 2, -1):
        if 4 * n_u * sum(k**length for length in range(1, longest + 1)) <= len(record):
            return longest
    raise NotIdentifiableError(
        f"{len(record)} samples are too few for least squares with {k} functions of the scheduling and {n_u} inputs:"
        f" words of three letters make {n_u * (k + k**2 + k**3)} regressors; record four times as many samples",
        "scheduling",
    )
