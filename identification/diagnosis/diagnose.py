"""The diagnosis: is something missing, which effects have its shape, and which of them cannot be told apart."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.comparison.lack_of_fit import lack_of_fit
from identification.diagnosis.evidence import LONGER, STRICT, Evidence, ShortList, indistinguishable, refit_short_list
from identification.diagnosis.missing_law import is_law, with_law
from identification.diagnosis.record_by_record import record_by_record
from identification.diagnosis.remainder import MATERIAL, SmoothRemainder, rest
from identification.diagnosis.scores import Score, score_tests
from identification.diagnosis.signatures import Candidate, candidates
from identification.diagnosis.variances import Variation, describe, evenly_explained, variations, varied
from identification.diagnosis.verdict import PARTLY, Rest, Verdict, judged, why_not_all, why_not_judged
from identification.effects.library import library
from identification.effects.second_variable import with_logged
from identification.errors import MisuseError
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows
from identification.extension.settle import off_poles, settled
from identification.models.model import Model, require_matching
from identification.outcome import TestResult
from identification.places.place import Effect
from identification.places.ports import EVERYWHERE, Port
from identification.places.variance import ParameterSpread

DETECTION = 1.959963984540054 + 1.2815515655446004
LEVEL = 0.05


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
    port: Port = EVERYWHERE


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What is missing from a model.

    `base`: the model refitted to the data; `lack_of_fit` before, `remaining` after the best effect; `scores` of all
    visible effects, smallest adjusted p first; `evidence`: the refitted short list, best first; `announced`: those
    of it that cannot be told apart, empty when no effect passes the test of the whole family at 5 % or none is
    better than "none of these", whose share of all weights is `none_weight`; `reason` for the verdict;
    `rest_before`, `rest_after`: what is left beyond noise, relative to the output; `variation`: an effect on the
    variance that explains all that is missing, `variations`: those that show in how the periods differ; `notes` on
    measurements by their places; `confusability` (E, E): squared cosine between the signatures of `scores`;
    `visibility` of every effect of the library; `named`: what would be announced without the law, a curve of any shape;
    `behaves`: the first of those announced fits no better than such a curve, and is a likeness and not the cause.
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
    reason: str = ""
    rest_before: float = 0.0
    rest_after: float = 0.0
    none_weight: float = 1.0
    notes: tuple[tuple[int, str], ...] = ()
    variations: tuple[Variation, ...] = ()
    variation: Variation | None = None
    named: tuple[Evidence, ...] = ()
    behaves: bool = False

    @property
    def best(self) -> Evidence | None:
        """The announced effect of most weight; the simplest where the size of the noise is not known."""
        return self.announced[0] if self.announced else None

    @property
    def _explained(self) -> bool:
        return self.verdict == "explained" and Rest(self.remaining, self.rest_after).acceptable

    @property
    def left(self) -> Rest:
        """What the model leaves as it is."""
        return Rest(self.lack_of_fit, self.rest_before)

    @property
    def confident(self) -> bool:
        """Whether one effect has more than 95 % of the weight of all and explains what is missing; never the law."""
        certain = self.best is not None and self.best.weight > 1 - LEVEL and self._explained
        return certain and not self.behaves and self.best is not None and not is_law(self.best)


def rows_of(model: Model, batches: Sequence[Batch]) -> Rows:
    """The batches as rows for a model; noise of unknown size is scaled by what the model leaves."""
    require_matching(model, batches)
    rows = Rows(settled(model, [batch.in_parts() for batch in batches]))
    if rows.scaled:
        return rows
    parts = rows.parts(fit(model, rows).residual)
    pairs = zip(rows.batches, parts, strict=True)
    return Rows(rows.batches, tuple(1.0 if b.scaled else float(np.sqrt(p @ p / b.row_count)) for b, p in pairs))


def diagnose(
    model: Model,
    batches: Sequence[Batch],
    effects: Sequence[Effect] | None = None,
    degree: int = 0,
    seed: int = 0,
    material: float = MATERIAL,
) -> Diagnosis:
    """Which missing effect the measurements point to.

    θ (and the effects already in the model) are fitted first; every effect of the library is judged by its score
    test, the short list is refitted. `degree`: of the amplitudes as polynomials in p. Where all that is missing is at
    most `material`, as a share of the output beyond noise, nothing is refitted or announced: with little noise no plant
    is ever exact; the scores still tell what it looks like. Raises MisuseError when the measurements are not those of
    the model's time domain or range, or leave nothing to judge by.
    """
    require_matching(model, batches)
    model = off_poles(model, batches)
    rows = rows_of(model, batches)
    base = fit(model, rows, iterations=LONGER)
    if rows.count <= len(base.tangents):
        raise MisuseError("there are not more numbers than parameters; measure more lines", "experiments")
    judged_effects = candidates(base, with_logged(library() if effects is None else effects, batches), degree)
    seen = [one for one in judged_effects if one.signatures]
    scores = score_tests(base, seen, np.random.default_rng(seed))
    ordered = tuple(sorted(scores, key=lambda one: (one.adjusted_p, one.p_value, -one.statistic)))
    cannot = why_not_judged(base, batches)
    before = _rest("lack of fit", base, seed)
    missing = bool(ordered) and ordered[0].adjusted_p < LEVEL and before.share > material
    names = refit_short_list(base, ordered if missing else (), origin=model)
    listed, behaves = with_law(base, ordered if missing and not cannot else (), names)
    one_channel = rows.batches[0].shape == (1, 1)
    found = variations(base, np.random.default_rng(seed)) if rows.scaled and not cannot and one_channel else ()
    drifting = any(one.p_value < STRICT and one.effect.of_periods and one.gain > 0 for one in found)
    announced, named = (
        () if cannot else tuple(one for one in _announced(each) if not (drifting and one.misplaced))
        for each in (listed, names)
    )
    after = _rest("remaining lack of fit", announced[0].fit, seed) if announced else before
    varying = _instead(model, base, before, listed.evidence if announced or not before.acceptable else (), found)
    if varying is None:
        verdict, reason = judged(before, after, announced, cannot, why_not_all(batches))
        reason = _of_law(announced, behaves) + reason
    else:
        announced, named, after = (), (), varying[1]
        verdict, reason = "explained", f"{describe(varying[0])}; {after.words}; {varying[0].effect.advice}"
    return Diagnosis(
        base,
        before.test,
        ordered,
        listed.evidence,
        announced,
        after.test,
        announced[0].share if announced else 0.0,
        verdict,
        confusability(ordered),
        tuple(_visibility(one) for one in judged_effects),
        reason,
        before.share,
        after.share,
        listed.none_weight,
        tuple(sorted(note for batch in batches for note in batch.notes)),
        tuple(one for one in found if one.p_value < STRICT and one.effect.of_periods),
        None if varying is None else varying[0],
        named,
        behaves and bool(announced),
    )


def _of_law(announced: Sequence[Evidence], behaves: bool) -> str:
    """What is to be said first where a curve without a name fits better than names, or as well."""
    if announced and is_law(announced[0]):
        law = announced[0].fit.model.effects[-1].effect
        return f"no effect of the library has this shape, a curve {law.describe()} has; "
    if announced and behaves:
        name = announced[0].score.candidate.effect.title
        return f"it behaves like {name}, which need not be the cause, as a curve of any shape fits as well; "
    return ""


def _instead(
    model: Model, base: Fit, before: Rest, evidence: Sequence[Evidence], found: Sequence[Variation]
) -> tuple[Variation, Rest] | None:
    """An effect on the variance that explains all that is missing, better than every effect on the mean; and the rest.

    −2 ln L with its variance, ln R for its size and 2 ln(variants) are held against the BIC of the others. A parameter
    that was seen to drift within the records is elsewhere in each by as much, and comes before a misplaced point.
    What scatters with the rate of the output is not called a power that all lines share.
    """
    if before.acceptable and not evidence:
        return None
    scattering = any(one.p_value < STRICT and one.gain == 0 for one in found)
    for one in sorted(found, key=lambda each: -each.gain):
        if one.p_value >= STRICT or one.gain == 0 or (scattering and one.effect.power(base.flows[0]) is not None):
            continue
        rivals = [each for each in evidence if not (one.effect.of_periods and each.misplaced)]
        varying, left, bic = _scattered(base, one, before) or _spread(model, base, one, before)
        if left.acceptable and all(bic < other.bic for other in rivals):
            return varying, left
    return None


def _scattered(base: Fit, one: Variation, before: Rest) -> tuple[Variation, Rest, float] | None:
    """What a coefficient of its own in every record leaves, however much it varies, with its BIC; the best coefficient.

    None for what varies otherwise, and where records do not tell their coefficients.
    """
    if not (isinstance(one.effect, ParameterSpread) and one.effect.within_points):
        return None
    records = record_by_record(base)
    if records is None:
        return None
    tried = [(records.scattered(i), i) for i in range(records.coefficients.shape[1])]
    (size, off, spread), i = min(tried, key=lambda each: each[0][1] + each[0][2])
    freedom = float(base.rows.shares.sum()) - len(base.tangents)
    test = lack_of_fit("lack of fit with the variance", records.energy + off, freedom, base.rows.noise_freedom)
    varying = replace(one, effect=replace(one.effect, coefficient=i), size=size)
    return varying, _beyond(before, test), records.energy + off + spread + _price(base, one)


def _price(base: Fit, one: Variation) -> float:
    return float(np.log(base.rows.count) + 2 * np.log(one.variants))


def _spread(model: Model, base: Fit, one: Variation, before: Rest) -> tuple[Variation, Rest, float]:
    """What a variance of its size leaves, to first order in what varies, and its BIC."""
    rows = Rows(varied(base, one), base.rows.scales)
    grown = fit(model, rows, iterations=LONGER)
    left = _beyond(before, misfit("lack of fit with the variance", grown))
    shaped = one.effect.power(base.flows[0]) is None or evenly_explained(grown)
    bic = float(grown.residual @ grown.residual) + _spread_out(rows, base.rows) + _price(base, one)
    return one, left, bic if shaped else np.inf


def _beyond(before: Rest, after: TestResult) -> Rest:
    """What a variance leaves: of what was left before the same part as of χ² beyond its degrees of freedom."""
    excess, was = (max(one.statistic - one.degrees_of_freedom, 0.0) for one in (after, before.test))
    return Rest(after, before.share * float(np.sqrt(excess / max(was, 1.0))))


def _spread_out(rows: Rows, noise: Rows) -> float:
    """ln det of the variance of the records against that of the noise alone."""
    total = sum(batch.log_determinant for batch in rows.batches)
    for wider, alone in zip(rows.batches, noise.batches, strict=True):
        used = alone.weights_of_rows > 0
        total += 2 * float(np.sum(np.log(alone.weights_of_rows[used] / wider.weights_of_rows[used])))
    return total


def _announced(listed: ShortList) -> tuple[Evidence, ...]:
    """The best effects, where they are better than "none of these" and take away a fair share of what is missing.

    What fits as well as a point that was logged wrongly comes before it: the other points must bear it out alone.
    """
    found = [one for one in listed.evidence if one.announceable]
    if not found or found[0].beside >= listed.none_beside:
        return ()
    alike = indistinguishable(found)
    ordered = tuple(sorted(alike, key=lambda one: one.misplaced))
    return ordered if ordered[0].share >= PARTLY else ()


def _rest(name: str, found: Fit, seed: int) -> Rest:
    noise = 1.0 if found.rows.scaled else SmoothRemainder(found).of(found).noise
    return Rest(misfit(name, found, seed), rest(found, noise))


def misfit(name: str, found: Fit, seed: int = 0) -> TestResult:
    """Lack of fit of a fitted model; where the size of the noise is not known, whether what it leaves is smooth."""
    if not found.rows.scaled:
        return SmoothRemainder(found).test(name, found, seed)
    judged_part = found.rows.judged(found.residual)
    freedom = float(found.rows.shares.sum()) - len(found.tangents)
    return lack_of_fit(name, float(judged_part @ judged_part), freedom, found.rows.noise_freedom)


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
        return Visibility(candidate.effect, None, 0.0, candidate.why_not, candidate.judged, candidate.port)
    best = max(candidate.signatures, key=lambda one: float(np.linalg.norm(one.gain)))
    detectable = DETECTION / float(np.linalg.norm(best.gain, 2))
    return Visibility(best.placed.effect, detectable, best.kept, port=candidate.port)
