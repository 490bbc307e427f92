"""Refit of the short list, and how much each effect then explains."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.diagnosis.scores import Score
from identification.extension.fit import Fit, fit
from identification.extension.model import PlacedEffect
from identification.places.simulate import NoSteadyStateError

SHORT_LIST = 8
STARTS = 2
LIKELY = 6.0
HOPELESS = 60.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """An effect after its refit with θ; `explained`: the fall of minus twice the log-likelihood; low `bic` is good.

    `weight`: share of exp(−BIC/2) among the short list and the model as it is.
    """

    score: Score
    fit: Fit
    explained: float
    parameters: int
    bic: float
    weight: float = 0.0

    @property
    def explained_per_parameter(self) -> float:
        """χ² explained for each added parameter."""
        return self.explained / self.parameters


def refit_short_list(base: Fit, scores: Sequence[Score], length: int = SHORT_LIST) -> tuple[Evidence, ...]:
    """θ and each of the effects of largest score together, from several starts, with their weights, best first.

        BIC = −2 ln L + (number of parameters) ln R,   weight ∝ exp(−BIC/2)

    Further parameters that are searched but not fitted cost 2 ln(number of variants).
    """
    ordered = sorted(scores, key=lambda score: -score.statistic)[:length]
    found: list[Evidence] = []
    least = np.inf
    for score in ordered:
        one = _refitted(base, score, least + HOPELESS)
        if one is not None:
            found.append(one)
            least = min(least, float(one.fit.residual @ one.fit.residual))
    return tuple(sorted(_weighted(base, found), key=lambda one: one.bic))


def _refitted(base: Fit, score: Score, hopeless: float) -> Evidence | None:
    fits = [one for start in _starts(base, score) if (one := _attempt(base, score, start, hopeless)) is not None]
    if not fits:
        return None
    best = min(fits, key=lambda one: one.cost)
    effect = best.model.effects[-1]
    if _outside(effect, best):
        return None
    parameters = len(effect.parameters())
    searched = 0.0 if effect.effect.fitted_names() else 2 * np.log(max(_tried(score), 1))
    penalty = parameters * np.log(base.rows.count) + searched
    return Evidence(score, best, base.cost - best.cost, parameters, float(best.cost + penalty))


def _outside(one: PlacedEffect, found: Fit) -> bool:
    """Whether the fit has left the physical range, or was held by its ends: then it is not this effect."""
    bound = one.effect.largest
    if bound is not None and np.max(abs(one.coefficients)) > 1.2 * bound:
        return True
    low, high = one.effect.limits(found.flows[0])
    values = one.effect.values()
    return bool(np.any(values <= low * (1 + 1e-6)) or np.any(values >= high * (1 - 1e-6)))


def _tried(score: Score) -> int:
    return max(len(score.candidate.signatures), score.candidate.looked_at)


def _starts(base: Fit, score: Score) -> list[int]:
    """The best variant, and for effects with further parameters the best of those that are not its neighbours."""
    signatures = score.candidate.signatures
    if len(signatures) == 1 or not score.candidate.effect.fitted_names():
        return [score.best]
    sizes = np.array([float(np.sum((one.basis @ base.residual) ** 2)) for one in signatures])
    sizes[abs(np.arange(len(sizes)) - score.best) <= 2] = -1.0
    other = int(np.argmax(sizes))
    return [score.best, other] if sizes[other] > 0.7 * score.statistic and STARTS > 1 else [score.best]


def _attempt(base: Fit, score: Score, variant: int, hopeless: float) -> Fit | None:
    signature = score.candidate.signatures[variant]
    amplitudes = signature.amplitudes(base.residual)
    bound = signature.placed.effect.largest
    if bound is not None:
        amplitudes = np.clip(amplitudes, -bound, bound)
    for share in (1.0, 0.3):
        start = replace(signature.placed, coefficients=_signed(signature.placed, share * amplitudes))
        try:
            return fit(base.model.plus(start), base.rows, iterations=12, tolerance=0.05, hopeless=hopeless)
        except NoSteadyStateError:
            continue
    return None


def _signed(one: PlacedEffect, amplitudes: FloatArray) -> FloatArray:
    effect, shape = one.effect, one.coefficients.shape
    values = amplitudes.reshape(shape)
    if effect.sign and amplitudes.size == 1:
        values = effect.sign * np.maximum(effect.sign * values, 0.0)
    return np.asarray(values, dtype=np.float64)


def _weighted(base: Fit, found: Sequence[Evidence]) -> list[Evidence]:
    values = np.array([base.cost, *(one.bic for one in found)])
    weights = np.exp(-(values - values.min()) / 2)
    weights /= weights.sum()
    return [replace(one, weight=float(w)) for one, w in zip(found, weights[1:], strict=True)]


def indistinguishable(ordered: Sequence[Evidence], share: float = 0.95) -> tuple[Evidence, ...]:
    """The smallest set of effects with this share of the weight, and all whose BIC is within 6 of the best."""
    kept: list[Evidence] = []
    total = sum(one.weight for one in ordered)
    for one in ordered:
        gathered = sum(other.weight for other in kept)
        if kept and gathered >= share * total and one.bic > ordered[0].bic + LIKELY:
            break
        kept.append(one)
    return tuple(kept)
