"""Affine state-space models from one experiment with varying scheduling: correlation analysis, then Ho–Kalman."""

from dataclasses import dataclass
from typing import Annotated, Literal, Protocol

import numpy as np

from identification.affine_state_space import AffineStateSpace, Matrices, simulate_matrices
from identification.arrays import FloatArray
from identification.correlation_analysis import WhiteExcitation
from identification.correlation_assumptions import (
    broken_assumptions,
    correlation_applies,
    noise_tests,
    signal_tests,
)
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.ho_kalman import Realisation, full_realisation, largest_entries, reduced_realisation
from identification.outcome import Outcome, TestResult
from identification.output_error import output_error
from identification.sub_markov import BasisSelection, ExactSubMarkov, SubMarkovSource, SummedSubMarkov, every_word
from identification.sub_markov_least_squares import WordRegression
from identification.varying import VaryingRecord

NOISE_FREE = 1e-5


@dataclass(frozen=True, eq=False)
class CorrelationEstimate:
    """A model from a varying experiment, and what it stands on.

    `singular_values` of the Hankel matrix of the first realisation; `rows`, `columns`: the bases selected;
    `corrections`: how many were made; `covariance` (n_θ, n_θ) of the entries of the model, see
    `identification.output_error`, and `noise_covariance` (n_y, n_y): None without refinement; `tests` of the
    assumptions A1–A3; `warnings`: those that the data break; `parameters`: how the sub-Markov parameters were found.
    """

    model: AffineStateSpace
    outcome: Outcome
    tests: tuple[TestResult, ...]
    warnings: tuple[str, ...]
    parameters: Literal["correlation", "least_squares"]
    singular_values: FloatArray
    rows: BasisSelection
    columns: BasisSelection
    corrections: int
    covariance: FloatArray | None
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

    order: Annotated[int | None, "state dimension; none takes it from the singular values"] = None
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
        if self.order is not None and self.order < 1:
            raise RangeError(f"the order is {self.order}; it must be at least 1", "order")

    def estimate(self, record: VaryingRecord) -> CorrelationEstimate:
        """The model of a record with varying scheduling that starts from rest.

        Input and scheduling may be anything for least squares; correlation needs both white (A2, A3), which is tested.
        Raises NotIdentifiableError when scheduling or input are not rich enough for the words or the record too short,
        RangeError for bases that the Hankel matrix does not have.
        """
        psi = np.concatenate([np.ones((len(record), 1)), record.scheduling], axis=1)
        tests = signal_tests(psi, record.input)
        white = self.parameters == "correlation" or (self.parameters == "automatic" and correlation_applies(tests))
        longest = _words_within(record, self.word_length)
        fitter: _Fitter = WhiteExcitation(psi, record.input) if white else WordRegression(psi, record.input, longest)
        depths = (self.word_length, self.word_length) if white else ((longest - 1) // 2, longest // 2)
        bases, first = self._first(fitter.fit(record.output), depths)
        found, corrections = self._corrected(first, bases, depths, fitter, record)
        return self._described(record, found, first, bases, corrections, tests, white)

    def _first(
        self, source: SubMarkovSource, depths: tuple[int, int]
    ) -> tuple[tuple[BasisSelection, BasisSelection], Realisation]:
        k, n_y, n_u = source.direct().shape
        rows, columns = every_word(max(depths[0], 1), k, n_y), every_word(max(depths[1], 1), k, n_u)
        if self.hankel == "reduced":
            at_rows, at_columns = largest_entries(
                source.hankel(rows, columns), min(self.rows, len(rows)), min(self.columns, len(columns))
            )
            rows, columns = rows.subset(at_rows), columns.subset(at_columns)
        return (rows, columns), self._realised(source, (rows, columns), depths, self.order)

    def _realised(
        self,
        source: SubMarkovSource,
        bases: tuple[BasisSelection, BasisSelection],
        depths: tuple[int, int],
        order: int | None,
    ) -> Realisation:
        if self.hankel == "full":
            return full_realisation(source, depths, order)
        return reduced_realisation(source, *bases, order)

    def _corrected(
        self,
        first: Realisation,
        bases: tuple[BasisSelection, BasisSelection],
        depths: tuple[int, int],
        fitter: _Fitter,
        record: VaryingRecord,
    ) -> tuple[Realisation, int]:
        """Corrections while each takes at least 1 % off the output error; an order not given is taken anew each time."""
        best, errors = first, _errors(first.matrices, record)
        for count in range(self.corrections):
            source = SummedSubMarkov(ExactSubMarkov(*best.matrices), fitter.fit(errors))
            trial = self._realised(source, bases, depths, self.order)
            after = _errors(trial.matrices, record)
            if not np.linalg.norm(after) < 0.99 * np.linalg.norm(errors):
                return best, count
            best, errors = trial, after
        return best, self.corrections

    def _described(
        self,
        record: VaryingRecord,
        found: Realisation,
        first: Realisation,
        bases: tuple[BasisSelection, BasisSelection],
        corrections: int,
        tests: tuple[TestResult, ...],
        white: bool,
    ) -> CorrelationEstimate:
        model = found.model(record.sample_time, record.variables)
        errors, outcome = _errors(found.matrices, record), Outcome("converged", "", corrections)
        covariance = noise_covariance = None
        if self.refinement:
            refined = output_error(model, record)
            model, outcome, errors = refined.model, refined.outcome, refined.errors
            covariance, noise_covariance = refined.covariance, refined.noise_covariance
        if not np.all(np.isfinite(errors)):
            advice = "the model is unstable along this scheduling; choose another order or allow corrections"
            outcome = Outcome("not_converged", advice, corrections)
        elif (self.refinement or corrections) and np.linalg.norm(errors) > NOISE_FREE * np.linalg.norm(record.output):
            tests = (*tests, *noise_tests(errors))
        return CorrelationEstimate(
            model,
            outcome,
            tests,
            broken_assumptions(tests, white),
            "correlation" if white else "least_squares",
            first.singular_values,
            *bases,
            corrections,
            covariance,
            noise_covariance,
        )

    @classmethod
    def example(cls) -> "CorrelationRealisation":
        """A small one, for the conformance tests."""
        return cls(order=1, rows=4, columns=4)


def _errors(matrices: Matrices, record: VaryingRecord) -> FloatArray:
    return np.asarray(record.output - simulate_matrices(matrices, record.input, record.scheduling))


def _words_within(record: VaryingRecord, word_length: int) -> int:
    """Letters of the longest words, at most 2 · word_length + 1, with four samples for each regressor."""
    k, n_u = record.scheduling.shape[1] + 1, record.input.shape[1]
    for longest in range(2 * word_length + 1, 2, -1):
        if 4 * n_u * sum(k**length for length in range(1, longest + 1)) <= len(record):
            return longest
    raise NotIdentifiableError(
        f"{len(record)} samples are too few for least squares with {k - 1} scheduling signals and {n_u} inputs:"
        f" words of three letters make {n_u * (k + k**2 + k**3)} regressors; record four times as many samples as regressors",
        "scheduling",
    )
