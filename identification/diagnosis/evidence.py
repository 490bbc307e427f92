"""Refit of the short list, and how much each effect then explains."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.lack_of_fit import lack_of_fit
from identification.diagnosis.measured_scan import on_signals, strong_starts
from identification.diagnosis.penalised import is_penalised
from identification.diagnosis.remainder import MATERIAL, Remainder, SmoothRemainder, rest
from identification.diagnosis.scans import misfit_is_large, scanned_starts, states_scan
from identification.diagnosis.scores import Score
from identification.effects.misplaced_point import MisplacedPoint
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.places.placed import PlacedEffect
from identification.places.steady import NoSteadyStateError

SHORT_LIST = 8
STARTS, NEAR, APART = 3, 0.5, 2
LIKELY = 6.0
ALIKE = 2.0
HOPELESS, HOPELESS_SHARE = 60.0, 1.5
HELD = 10.0
NOISE = 1.5
LONGER = 40
STRICT = 1e-3
IN_THE_RUNNING = 0.5


@dataclass(frozen=True, eq=False)
class Evidence:
    """An effect after its refit with θ; `explained`: the fall of minus twice the log-likelihood; low `bic` is good.

    `remainder`: what it leaves beside noise; `beside`: minus twice the log-likelihood with that, with all prices;
    `share` of what the model lacked that it takes away; `weight`: its share of all, "none of these" included.
    `at_bound`: it was held by the end of its physical range, so that its value is no estimate.
    """

    score: Score
    fit: Fit
    remainder: Remainder
    explained: float
    parameters: int
    bic: float
    beside: float
    share: float
    at_bound: bool = False
    weight: float = 0.0

    @property
    def explained_per_parameter(self) -> float:
        """χ² explained for each added parameter."""
        return self.explained / self.parameters

    @property
    def misplaced(self) -> bool:
        """Whether it is an operating point logged wrongly."""
        return isinstance(self.fit.model.effects[-1].effect, MisplacedPoint)

    @property
    def announceable(self) -> bool:
        """Whether the refit came to an end, and not at an amplitude of nought."""
        return self.fit.outcome.ok and bool(np.any(self.fit.model.effects[-1].coefficients))


@dataclass(frozen=True, eq=False)
class ShortList:
    """The refitted effects, best first, and "none of these": remainder, `beside` as in `Evidence`, weight."""

    evidence: tuple[Evidence, ...]
    none: Remainder
    none_beside: float
    none_weight: float


def refit_short_list(
    base: Fit, scores: Sequence[Score], length: int = SHORT_LIST, origin: Model | None = None
) -> ShortList:
    """θ and each of the effects of largest score together, from several starts, with their weights, best first.

        BIC_j = −2 ln L + (number of parameters) ln R,   weight_j = x_j e^{−BIC_j/2}/Σ e^{−BIC/2}

    x_j is the share of what is missing that the effect takes away; what it leaves is none of these. Their own
    e^{−BIC/2} is held against that of the best effect with r ~ N(s_j e, V + τ_j² S) for both, without s_j for none,
    τ by restricted likelihood (`SmoothRemainder`), so that a free smooth response wins where no effect has the
    shape. Further parameters that are searched but not fitted cost 2 ln(number of variants), values on a physical
    bound `HELD`. Where the size of the noise is not known, R is the effective number of residuals of the best
    refit, and ln L is that of so many. Where much is missing, effects that state a scan are on the list in any case
    and begin from the best of it too; `origin`: the model as it was given, around which it is made. Effects on signals
    begin from the measured output in their laws where much more than noise is missing (`strong_starts`). Curves without
    a name are not on the list (`missing_law`).
    """
    model = SmoothRemainder(base)
    none = model.of(base)
    beside = _penalised(none, base)
    named = [score for score in scores if not is_penalised(score.candidate.effect)]
    ordered = sorted(named, key=lambda score: -score.statistic)
    large = misfit_is_large(base)
    first = {score.candidate.effect.kind: score for score in reversed(ordered)}
    scanned = {id(score) for score in first.values() if large and states_scan(score.candidate.effect)}
    strong = {id(ordered[i]): starts for i, starts in strong_starts(base, ordered).items()}
    ordered = [
        score for score in ordered if not strong or id(score) in strong or not on_signals(score.candidate.effect)
    ]
    ordered = [score for i, score in enumerate(ordered) if i < length or id(score) in {*scanned, *strong}]
    ranked = list(strong)
    ordered.sort(key=lambda score: ranked.index(id(score)) if id(score) in strong else len(ranked))
    ordered.sort(key=lambda score: bool(score.candidate.effect.refines))
    found: list[tuple[Score, Fit]] = []
    least = np.inf
    for score in ordered:
        hopeless = (1.0 if base.rows.scaled else HOPELESS_SHARE) * least + HOPELESS
        if _needless(base, score, found):
            continue
        around = origin if id(score) in scanned and not least < NOISE * base.rows.count else None
        one = _refitted(base, score, hopeless, around, strong.get(id(score), ()))
        if one is not None:
            found.append((score, one))
            least = min(least, float(one.residual @ one.residual))
    if not found:
        return ShortList((), none, beside, 1.0)
    best = min((one for _, one in found), key=lambda one: one.cost)
    found = [(score, _let_go(base, one, best)) for score, one in found]
    best = min((one for _, one in found), key=lambda one: one.cost)
    count = effective_count(best.rows, best.residual)
    evidence = sorted((_judged(model, *pair, count) for pair in found), key=lambda one: one.bic)
    shared = weighted(beside, _without_needless(evidence))
    return ShortList(tuple(shared), none, beside, 1 - sum(one.weight for one in shared))


def _needless(base: Fit, score: Score, found: Sequence[tuple[Score, Fit]]) -> bool:
    """Whether the effect refines one that leaves nothing material."""
    plain = [one for other, one in found if other.candidate.effect.kind == score.candidate.effect.refines]
    noise = 1.0 if base.rows.scaled else SmoothRemainder(base).of(base).noise
    return any(one.outcome.ok and explained_share(base, one, noise) >= 1 for one in plain)


def _without_needless(ordered: Sequence[Evidence]) -> list[Evidence]:
    """Without effects that refine another one, unless they take at least half of a material rest that it leaves."""
    left = {
        (c.effect.kind, c.port): 1 - one.share for one in ordered if one.announceable for c in [one.score.candidate]
    }

    def needed(one: Evidence) -> bool:
        plain = left.get((one.score.candidate.effect.refines, one.score.candidate.port))
        return plain is None or (plain > 0 and 1 - one.share <= plain / 2)

    return [one for one in ordered if needed(one)]


def effective_count(rows: Rows, residual: FloatArray) -> float:
    """How many independent numbers a whitened residual (R,) is worth: R where the size of the noise is known.

    Otherwise the errors are mostly those of the model, smooth over frequency and alike at all operating points, and R
    would overstate every difference of likelihoods. From each batch Z (2M, K) of real and imaginary parts,

        ρ = Σ z_ck z_c,k+1 / Σ z_ck²,   K (1 − ρ)/(1 + ρ) (Σ s_i²)²/Σ s_i⁴,   s the singular values of Z

    the number of independent values of a first-order autoregression, times the number of records that do not repeat
    each other; two at least, R at most [Bartlett1946].
    """
    if rows.scaled:
        return float(rows.count)
    total = 0.0
    for batch, compared, part in zip(rows.batches, rows.parts(_compared(rows)), rows.parts(residual), strict=True):
        z = part.reshape(-1, len(batch.omega))
        energy = np.linalg.svd(z, compute_uv=False) ** 2
        if batch.scaled or not energy.sum() > 0:
            total += float(compared.sum())
            continue
        rho = np.clip(np.sum(z[:, 1:] * z[:, :-1]) / np.sum(z**2), 0.0, 1 - 1e-6)
        repeats = energy.sum() ** 2 / np.sum(energy**2)
        total += float(min(z.shape[1] * (1 - rho) / (1 + rho) * repeats, compared.sum()))
    return max(total, 2.0)


def _compared(rows: Rows) -> FloatArray:
    return np.concatenate([batch.compared for batch in rows.batches]).astype(np.float64)


def _penalised(remainder: Remainder, found: Fit) -> float:
    price = remainder.hyperparameters * float(np.log(found.rows.count))
    return min(remainder.immaterial, remainder.cost + price)


def _judged(model: SmoothRemainder, score: Score, found: Fit, count: float) -> Evidence:
    base, effect = model.base, found.model.effects[-1]
    parameters = len(effect.parameters())
    searched = 0.0 if effect.effect.fitted_names() else 2 * np.log(max(_tried(score), 1))
    remainder = model.of(found)
    bound = on_bound(effect, found)
    explained = (base.cost - found.cost) * count / base.rows.count
    price = parameters * np.log(count) + searched + HELD * bound
    beside = _penalised(remainder, found) + parameters * np.log(base.rows.count)
    share = explained_share(base, found, remainder.noise)
    bic = float(base.cost - explained + price)
    return Evidence(score, found, remainder, explained, parameters, bic, float(beside), share, bound)


def explained_share(base: Fit, found: Fit, noise: float = 1.0) -> float:
    """How much of what noise does not explain a fit takes away; one where what it leaves is noise or immaterial."""
    lacked, left = (
        float(one.residual @ one.residual) / noise - (one.rows.count - len(one.tangents)) for one in (base, found)
    )
    if lacked <= 0 or left <= 0 or rest(found, noise) <= MATERIAL or noise_explains(found, noise):
        return 1.0
    return float(np.clip(1 - left / lacked, 0.0, 1.0))


def noise_explains(found: Fit, noise: float = 1.0) -> bool:
    """Whether the lack of fit of a fit has p of a thousandth or more with noise of this size."""
    part = found.rows.judged(found.residual)
    energy, freedom = float(part @ part) / noise, float(found.rows.shares.sum()) - len(found.tangents)
    return lack_of_fit("", energy, freedom, found.rows.noise_freedom).p_value >= STRICT


def _refitted(base: Fit, score: Score, hopeless: float, origin: Model | None, strong: Sequence[Fit] = ()) -> Fit | None:
    found = [fitted for start in strong if (fitted := _carried_on(start, hopeless)) is not None]
    attempts = [] if found else [_attempt(base, score, start, hopeless) for start in _starts(base, score)]
    found += [one for one in attempts if one is not None]
    if origin is not None:
        starts = scanned_starts(base, origin, score.signature.placed)
        found += [fit(start, base.rows, iterations=13, tolerance=0.05) for start in starts]
    if not found:
        return None
    best = min(found, key=lambda one: one.cost)
    if not best.outcome.ok and float(best.residual @ best.residual) < hopeless:
        best = fit(best.model, base.rows, iterations=LONGER, tolerance=0.05, start=best.flows)
    return None if _beyond(best.model.effects[-1]) else best


def _let_go(base: Fit, found: Fit, best: Fit) -> Fit:
    """A fit that is in the running, with a further parameter of its effect let go where that lowers BIC by six."""
    noise = found.rows.scaled and found.cost < found.rows.count
    if noise or base.cost - found.cost < IN_THE_RUNNING * (base.cost - best.cost):
        return found
    count = effective_count(best.rows, best.residual)

    def price(one: Fit) -> float:
        return one.cost * count / one.rows.count + len(one.model.effects[-1].parameters()) * float(np.log(count))

    freer = [one for one in _freer(found) if not _beyond(last := one.model.effects[-1]) and not on_bound(last, one)]
    other = min(freer, key=price, default=found)
    return other if price(other) < price(found) - LIKELY else found


def _freer(found: Fit) -> list[Fit]:
    """Fits with one further parameter of the effect let go."""
    last, rest = found.model.effects[-1], found.model.effects[:-1]
    points = np.concatenate([flow.setting.points for flow in found.flows])
    moving = [replace(last, effect=one) for one in last.effect.freer(points)]
    models = [replace(found.model, effects=(*rest, one), joint_covariance=None) for one in moving]
    return [fit(model, found.rows, iterations=13, tolerance=0.05, start=found.flows) for model in models]


def _beyond(one: PlacedEffect) -> bool:
    """Whether the amplitude has left its physical range: then it is not this effect."""
    bound = one.effect.largest
    return bound is not None and bool(np.max(abs(one.coefficients)) > 1.2 * bound)


def on_bound(one: PlacedEffect, found: Fit) -> bool:
    """Whether the further parameters of an effect were held by an end of their range."""
    low, high = one.effect.limits(found.flows[0])
    values = one.effect.values()
    return bool(np.any(values <= low * (1 + 1e-6)) or np.any(values >= high * (1 - 1e-6)))


def _tried(score: Score) -> int:
    return max(len(score.candidate.signatures), score.candidate.looked_at)


def _starts(base: Fit, score: Score) -> list[int]:
    """The best variant and up to two more that come near it; where parameters are fitted, none next to another."""
    signatures = score.candidate.signatures
    sizes = np.array([float(np.sum((one.basis @ base.residual) ** 2)) for one in signatures])
    apart = APART if score.candidate.effect.fitted_names() else 0
    found = [score.best]
    while len(found) < STARTS:
        near = np.min(abs(np.arange(len(sizes))[:, None] - found), axis=1) <= apart
        other = int(np.argmax(np.where(near, -1.0, sizes)))
        if not sizes[other] > NEAR * score.statistic or near[other]:
            break
        found.append(other)
    return found


def _attempt(base: Fit, score: Score, variant: int, hopeless: float) -> Fit | None:
    """From amplitude zero, so that the first step, halved where it is too long, is the one that the score points to.

    None for a motion that these signals do not let be computed.
    """
    start = score.candidate.signatures[variant].placed
    absent = base.model.plus(replace(start, coefficients=np.zeros_like(start.coefficients)))
    try:
        return fit(absent, base.rows, iterations=13, tolerance=0.05, hopeless=hopeless, start=base.flows)
    except NoSteadyStateError:
        return None


def _carried_on(start: Fit, hopeless: float) -> Fit | None:
    """From what the measured output in the law gives; None where no steady state is found there."""
    try:
        return fit(start.model, start.rows, iterations=13, tolerance=0.05, hopeless=hopeless, start=start.flows)
    except NoSteadyStateError:
        return None


def weighted(none: float, ordered: Sequence[Evidence]) -> list[Evidence]:
    """With the weights of all; `none`: minus twice the log-likelihood of the smooth remainder alone, with its price."""
    values = np.array([one.bic for one in ordered])
    against = ordered[0].bic + none - ordered[0].beside
    likely = np.exp(-(np.append(values, against) - min(values.min(), against)) / 2)
    likely /= likely.sum()
    return [replace(one, weight=float(w) * one.share) for one, w in zip(ordered, likely, strict=False)]


def indistinguishable(ordered: Sequence[Evidence], share: float = 0.95) -> tuple[Evidence, ...]:
    """The smallest set of effects with this share of the weight, and all whose BIC is within 6 of the best.

    Where the size of the noise is not known: those within 6 whose signature is mostly that of the best, as others may
    be missing as well and not instead; first the simplest of those within 2, a difference not worth more than a bare
    mention [KassRaftery1995].
    """
    if ordered and not ordered[0].fit.rows.scaled:
        best = ordered[0]
        alike = [one for one in ordered if one.bic <= best.bic + LIKELY and overlap(one, best) > 0.5]
        first = simplest([one for one in alike if one.bic <= best.bic + ALIKE])
        return (first, *(one for one in alike if one is not first))
    kept: list[Evidence] = []
    likely = np.exp(-(np.array([one.bic for one in ordered]) - min((one.bic for one in ordered), default=0.0)) / 2)
    gathered = 0.0
    for one, own in zip(ordered, likely, strict=True):
        if kept and gathered >= share * likely.sum() and one.bic > ordered[0].bic + LIKELY:
            break
        kept.append(one)
        gathered += own
    return tuple(kept)


def overlap(one: Evidence, other: Evidence) -> float:
    """The largest squared cosine between the projected signatures of two effects."""
    product = one.score.signature.basis @ other.score.signature.basis.T
    return float(np.linalg.norm(product, 2) ** 2)


def simplest(alike: Sequence[Evidence]) -> Evidence:
    """The effect with the fewest parameters, then states, then one of the plant's own domain, of those that fit alike.

    After each of the three questions only those within 2 of the best BIC among the remaining ones stay.
    """
    questions: tuple[Callable[[Evidence], float], ...] = (
        lambda one: one.parameters,
        lambda one: one.score.candidate.effect.states,
        lambda one: one.score.candidate.effect.domain == "general",
    )
    left = list(alike)
    for question in questions:
        least = min(question(one) for one in left)
        left = [one for one in left if question(one) == least]
        best = min(one.bic for one in left)
        left = [one for one in left if one.bic <= best + ALIKE]
    return min(left, key=lambda one: one.bic)
