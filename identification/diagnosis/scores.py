"""Rao score tests of all effects from one fit, with one error rate for the whole family."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import chdtrc, erfc, fdtrc

from identification.arrays import FloatArray
from identification.diagnosis.penalised import CurveTest, is_penalised
from identification.diagnosis.signatures import Candidate, Signature
from identification.extension.fit import Fit

DRAWS = 4000


@dataclass(frozen=True, eq=False)
class Score:
    """The score test of one effect: the best variant, its statistic S, p alone and adjusted for all that was tried."""

    candidate: Candidate
    best: int
    statistic: float
    p_value: float
    adjusted_p: float

    @property
    def signature(self) -> Signature:
        """The signature of the best variant."""
        return self.candidate.signatures[self.best]


def score_tests(fit: Fit, seen: Sequence[Candidate], generator: np.random.Generator) -> tuple[Score, ...]:
    """The tests of the visible effects, S = ‖Q r‖² with Q the projected signature.

    For effects whose amplitudes are penalised S is the restricted likelihood ratio of none (`CurveTest`).

    S is χ² with as many degrees of freedom as amplitudes, or F where the noise variance was estimated; one-sided where
    the sign of the amplitude is physical. p of an effect with several variants, and p of the family of effects, come
    from draws of the joint normal distribution of all Q r, whose covariance Q Qᵀ is known; below the smallest p that
    the draws resolve they are bounded by the sum over what was tried. The best variant is the one that explains most,
    S − c ln R with c amplitudes: p of variants that meet noise variances of different freedom cannot be compared.
    """
    if not seen:
        return ()
    signatures = [one for candidate in seen for one in candidate.signatures]
    statistics = [_statistic(one, fit.residual) for one in signatures]
    alone = np.array([_p_value(fit, one, s) for one, s in zip(signatures, statistics, strict=True)])
    least_null = _null_least(seen, generator)
    ends = np.cumsum([0, *(len(candidate.signatures) for candidate in seen)])
    groups = [slice(a, b) for a, b in pairwise(ends)]
    least = np.array([alone[group].min() for group in groups])
    tried = np.array([max(len(c.signatures), c.looked_at) for c in seen])
    own = np.array([_own(p, least_null[:, e], c, tried[e]) for e, (p, c) in enumerate(zip(least, seen, strict=True))])
    ranks = (np.argsort(np.argsort(least_null, axis=0), axis=0) + 1) / (len(least_null) + 1)
    smallest = np.sort(ranks.min(axis=1))
    family = [_tail(p, smallest, len(seen)) for p in own]
    worth = [s - _price(one, fit.rows.count) for one, s in zip(signatures, statistics, strict=True)]
    best = [int(np.argmax(worth[group])) for group in groups]
    flat = [statistics[group.start + b] for group, b in zip(groups, best, strict=True)]
    return tuple(Score(*one) for one in zip(seen, best, flat, map(float, own), family, strict=True))


def _statistic(one: Signature, residual: FloatArray) -> float:
    """S, with a minus sign where the amplitude would have to have the wrong sign."""
    projections = one.basis @ residual
    if is_penalised(one.placed.effect):
        return float(CurveTest.of(one).ratio(projections))
    wrong = _one_sided(one) and one.placed.effect.sign * projections[0] * one.gain[0, 0] < 0
    return float(projections @ projections) * (-1.0 if wrong else 1.0)


def _price(one: Signature, count: int) -> float:
    """c ln R; the likelihood ratio of penalised amplitudes has theirs."""
    return 0.0 if is_penalised(one.placed.effect) else len(one.basis) * float(np.log(count))


def _one_sided(one: Signature) -> bool:
    return len(one.basis) == 1 and one.placed.effect.sign != 0


def _p_value(fit: Fit, one: Signature, statistic: float) -> float:
    count = len(one.basis)
    if is_penalised(one.placed.effect):
        return _p_of_curve(fit, one)
    freedom, size = one.freedom, abs(statistic) / one.variance
    if not fit.rows.scaled:
        freedom = max(fit.rows.count - len(fit.tangents) - count, 1.0)
        size = size * freedom / max(float(fit.residual @ fit.residual) - size, np.finfo(float).tiny)
    elif np.isfinite(freedom):
        size = size * freedom / max(freedom - 2, 1.0)
    p = float(chdtrc(count, size) if np.isinf(freedom) else fdtrc(count, freedom, size / count))
    if not _one_sided(one):
        return p
    return p / 2 if statistic > 0 else 1 - p / 2


def _p_of_curve(fit: Fit, one: Signature) -> float:
    """A bound: the likelihood ratio is less than the χ² of all amplitudes; for the share of draws it only orders."""
    projections, count, freedom = one.basis @ fit.residual, len(one.basis), one.freedom
    scale = 1 / one.variance
    if not fit.rows.scaled:
        freedom = max(fit.rows.count - len(fit.tangents) - count, 1.0)
        left = float(fit.residual @ fit.residual) - float(projections @ projections)
        scale = freedom / max(left, np.finfo(float).tiny)
    elif np.isfinite(freedom):
        scale *= freedom / max(freedom - 2, 1.0)
    ratio = float(CurveTest.of(one).ratio(projections * np.sqrt(scale)))
    return float(chdtrc(count, ratio) if np.isinf(freedom) else fdtrc(count, freedom, ratio / count))


def _null_least(seen: Sequence[Candidate], generator: np.random.Generator) -> FloatArray:
    """The least p of the variants of every effect in draws of the joint null, (DRAWS, effects)."""
    signatures = [one for candidate in seen for one in candidate.signatures]
    stacked = np.concatenate([one.basis for one in signatures])
    values, vectors = np.linalg.eigh(stacked @ stacked.T)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    draws = generator.standard_normal((DRAWS, len(stacked))) @ root.T
    starts = np.cumsum([0, *(len(one.basis) for one in signatures)])
    result = np.empty((DRAWS, len(seen)))
    first = 0
    for e, candidate in enumerate(seen):
        last = first + len(candidate.signatures)
        result[:, e] = _least(candidate.signatures, draws[:, starts[first] : starts[last]])
        first = last
    return result


def _least(variants: Sequence[Signature], draws: FloatArray) -> FloatArray:
    """The least p over the variants for draws (DRAWS, Σ c) of their projections."""
    counts = np.array([len(one.basis) for one in variants])
    if is_penalised(variants[0].placed.effect):
        parts = np.split(draws, np.cumsum(counts)[:-1], axis=1)
        ratios = [CurveTest.of(one).ratio(part) for one, part in zip(variants, parts, strict=True)]
        return np.asarray(np.min([chdtrc(c, ratio) for c, ratio in zip(counts, ratios, strict=True)], axis=0))
    if counts.max() == 1:
        gains = np.array([float(one.gain[0, 0]) for one in variants])
        sign = variants[0].placed.effect.sign if _one_sided(variants[0]) else 0
        largest = (draws * np.sign(gains) * sign).max(axis=1) if sign else abs(draws).max(axis=1)
        return np.asarray(erfc(largest / np.sqrt(2)) / (2 if sign else 1))
    sizes = np.add.reduceat(draws**2, np.cumsum([0, *counts[:-1]]), axis=1)
    return np.asarray(np.min([chdtrc(c, sizes[:, v]) for v, c in enumerate(counts)], axis=0))


def _own(p: float, null: FloatArray, candidate: Candidate, tried: int) -> float:
    resolved = _tail(p, np.sort(null), len(candidate.signatures))
    extra = tried / len(candidate.signatures)
    return float(-np.expm1(extra * np.log1p(-min(resolved, 1 - 1e-16))))


def _tail(p: float, ordered: FloatArray, tried: int) -> float:
    """The share of draws as small as p; where fewer than ten are, the bound p times `tried`."""
    below = int(np.searchsorted(ordered, p, side="right"))
    share = (below + 1) / (len(ordered) + 1)
    return float(share if below >= 10 else min(p * tried, 1.0))
