"""The diagnosis: is something missing, which effects have its shape, and which of them cannot be told apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.comparison.lack_of_fit import lack_of_fit
from identification.diagnosis.evidence import Evidence, indistinguishable, refit_short_list
from identification.diagnosis.scores import Score, score_tests
from identification.diagnosis.signatures import Candidate, candidates
from identification.effects.library import library
from identification.effects.second_variable import with_logged
from identification.errors import MisuseError
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows
from identification.models.model import Model, require_matching
from identification.outcome import TestResult
from identification.places.place import Effect

Verdict = Literal["nothing missing", "explained", "partly explained", "not in the library"]
DETECTION = 1.959963984540054 + 1.2815515655446004
LEVEL = 0.05
STRICT = 1e-3
PARTLY = 0.3
ALMOST = 0.98


@dataclass(frozen=True, eq=False)
class Visibility:
    """The amplitude of an effect that a test at 5 % would find with 90 % power in this experiment; None: never.

    `reason` says why it is not seen, or, where it is not `judged`, why it was not looked for.
    """

    effect: Effect
    amplitude: float | None
    kept: float
    reason: str = ""
    judged: bool = True


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What is missing from a model.

    `base`: the model refitted to the data; `lack_of_fit` before, `remaining` after the best effect; `scores` of all
    visible effects, smallest adjusted p first; `evidence`: the refitted short list, best first; `announced`: those of
    it that cannot be told apart, empty when no effect passes the test of the whole family at 5 %; `confusability`
    (E, E): squared cosine between the signatures of `scores`; `visibility` of every effect of the library.
    """

    base: Fit
    lack_of_fit: TestResult
    scores: tuple[Score, ...]
    evidence: tuple[Evidence, ...]
    announced: tuple[Evidence, ...]
    remaining: TestResult
    explained_share: float
    verdict: Verdict
    confusability: FloatArray
    visibility: tuple[Visibility, ...]

    @property
    def best(self) -> Evidence | None:
        """The announced effect of most weight; the simplest where the size of the noise is not known."""
        return self.announced[0] if self.announced else None

    @property
    def confident(self) -> bool:
        """Whether one effect has more than 95 % of the weight and leaves nothing that noise does not explain."""
        return self.best is not None and self.best.weight > 1 - LEVEL and self.remaining.p_value >= STRICT


def rows_of(model: Model, batches: Sequence[Batch]) -> Rows:
    """The batches as rows for a model; noise of unknown size is scaled by what the model leaves."""
    require_matching(model, batches)
    rows = Rows(tuple(batches))
    if rows.scaled:
        return rows
    parts = rows.parts(fit(model, rows).residual)
    pairs = zip(batches, parts, strict=True)
    return Rows(rows.batches, tuple(1.0 if b.scaled else float(np.sqrt(p @ p / b.row_count)) for b, p in pairs))


def diagnose(
    model: Model,
    batches: Sequence[Batch],
    effects: Sequence[Effect] | None = None,
    degree: int = 0,
    seed: int = 0,
) -> Diagnosis:
    """Which missing effect the measurements point to.

    θ (and the effects already in the model) are fitted first; every effect of the library is judged by its score
    test, the short list is refitted. `degree`: of the amplitudes as polynomials in p. Raises MisuseError when the
    measurements are not those of the model's time domain or range, or leave nothing to judge by.
    """
    rows = rows_of(model, batches)
    base = fit(model, rows)
    if rows.count <= len(base.tangents):
        raise MisuseError("there are not more numbers than parameters; measure more lines", "experiments")
    before = misfit("lack of fit", base)
    judged = candidates(base, with_logged(library() if effects is None else effects, batches), degree)
    scores = score_tests(base, [one for one in judged if one.signatures], np.random.default_rng(seed))
    ordered = tuple(sorted(scores, key=lambda one: (one.adjusted_p, one.p_value, -one.statistic)))
    missing = bool(ordered) and ordered[0].adjusted_p < LEVEL
    evidence = refit_short_list(base, ordered, origin=model) if missing else ()
    announced = indistinguishable(evidence) if evidence and evidence[0].bic < base.cost else ()
    remaining = misfit("remaining lack of fit", announced[0].fit) if announced else before
    share = _explained_share(base, announced)
    return Diagnosis(
        base,
        before,
        ordered,
        evidence,
        announced,
        remaining,
        share,
        _verdict(before, announced, remaining, share),
        confusability(ordered),
        tuple(_visibility(one) for one in judged),
    )


def misfit(name: str, found: Fit) -> TestResult:
    """Lack of fit of a fitted model; nothing to test (p = 1) where the size of the noise is not known."""
    energy = float(found.residual @ found.residual)
    freedom = found.rows.count - len(found.tangents)
    if not found.rows.scaled:
        return TestResult(name, energy, float(freedom), 1.0)
    return lack_of_fit(name, energy, freedom, found.rows.noise_freedom)


def _explained_share(base: Fit, announced: Sequence[Evidence]) -> float:
    """How much of what noise does not explain the best effect takes away; 1 when there was nothing to explain."""
    if not announced or not base.rows.scaled:
        return 1.0
    expected = base.rows.count - len(base.tangents)
    return float(min(announced[0].explained / max(base.cost - expected, announced[0].explained, 1e-300), 1.0))


def _verdict(before: TestResult, announced: Sequence[Evidence], remaining: TestResult, share: float) -> Verdict:
    if not announced:
        return "not in the library" if before.p_value < STRICT else "nothing missing"
    if remaining.p_value >= STRICT or share >= ALMOST:
        return "explained"
    return "partly explained" if share >= PARTLY else "not in the library"


def confusability(scores: Sequence[Score]) -> FloatArray:
    """Largest squared cosine between the projected signatures of the best variants, (E, E); 1: cannot be told apart."""
    if not scores:
        return np.zeros((0, 0))
    bases = [score.signature.basis for score in scores]
    stacked = np.concatenate(bases)
    products = stacked @ stacked.T
    ends = np.cumsum([0, *(len(basis) for basis in bases)])
    result = np.ones((len(bases), len(bases)))
    for i in range(len(bases)):
        for j in range(i):
            block = products[ends[i] : ends[i + 1], ends[j] : ends[j + 1]]
            largest = float(np.max(np.linalg.svd(block, compute_uv=False)) ** 2)
            result[i, j] = result[j, i] = min(largest, 1.0)
    return result


def _visibility(candidate: Candidate) -> Visibility:
    if not candidate.signatures:
        return Visibility(candidate.effect, None, 0.0, candidate.why_not, candidate.judged)
    best = max(candidate.signatures, key=lambda one: float(np.linalg.norm(one.gain)))
    return Visibility(best.placed.effect, DETECTION / float(np.linalg.norm(best.gain, 2)), best.kept)
