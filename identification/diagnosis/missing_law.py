"""The missing law as evidence: fitted where no name of the library explains what is missing."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.diagnosis.evidence import (
    ALIKE,
    Evidence,
    ShortList,
    effective_count,
    explained_share,
    noise_explains,
    weighted,
)
from identification.diagnosis.measured_law import measured_fit
from identification.diagnosis.measured_scan import much_is_missing
from identification.diagnosis.penalised import CurveTest, is_penalised
from identification.diagnosis.remainder import SmoothRemainder
from identification.diagnosis.scores import Score
from identification.diagnosis.signatures import signature_of, tangent_space
from identification.extension.fit import Fit, fit, penalty
from identification.lti.whiteness import orthonormal
from identification.places.placed import PlacedEffect
from identification.places.steady import NoSteadyStateError

MOST_LEFT, BETTER = 1 / 16, 0.5
TRIED, NEAR = 2, 0.8
ROUNDS, SETTLED = 3, 0.3
ITERATIONS = 20


@dataclass(frozen=True, eq=False)
class LawFit:
    """A law after its refit with θ; `variant` of its score, `test` at the fit."""

    fit: Fit
    variant: int
    test: CurveTest

    @property
    def placed(self) -> PlacedEffect:
        """The law as fitted."""
        return self.fit.model.effects[-1]

    @property
    def log_determinant(self) -> float:
        """The price of the curve."""
        return self.test.log_determinant(_size(self.placed))

    @property
    def freedom(self) -> float:
        """How many free numbers the curve amounts to, Σ τ² d/(1 + τ² d)."""
        grown = _size(self.placed) ** 2 * self.test.sizes
        return float(np.sum(grown / (1 + grown)))

    @property
    def cost(self) -> float:
        """Minus twice the log-likelihood with the penalty."""
        rows, more = self.fit.rows, penalty(self.fit.model)
        if rows.scaled:
            return self.fit.cost + more
        energy = float(self.fit.residual @ self.fit.residual)
        return self.fit.cost + rows.count * float(np.log1p(more / max(energy, np.finfo(float).tiny)))


def with_law(base: Fit, scores: Sequence[Score], listed: ShortList) -> tuple[ShortList, bool]:
    """The short list with the law, where that is what is missing; whether the first of it merely behaves like the law.

    The law comes in where the best named effect leaves more than noise and what is material, and only if it leaves
    less than a sixteenth of what is missing and less than half of what the named effect does: a name that is right
    always stands before it. A named effect whose BIC is not at least two lower than that of a free curve fits no better
    than its shape does, and is said to behave like what is missing [KassRaftery1995].

        BIC = ‖r‖² + ‖e‖²/τ² + Σ ln(1 + τ² d) + ln R + 2 ln(places),   τ by restricted likelihood
    """
    score = next((one for one in scores if is_penalised(one.candidate.effect)), None)
    named = next((one for one in listed.evidence if one.announceable), None)
    if score is None:
        return listed, False
    wanted = named is None or named.share < 1
    if not wanted and named is not None and not _in_doubt(named, score):
        return listed, False
    with np.errstate(over="ignore", invalid="ignore"):  # trial steps of a curve may run away; they are not taken
        found = fitted_law(base, score)
    if found is None:
        return listed, False
    law = _evidence(base, score, found)
    if not wanted:
        return listed, named is not None and law.bic <= named.bic + ALIKE
    left = 1.0 if named is None else 1 - named.share
    if 1 - law.share > min(MOST_LEFT, BETTER * left):
        return listed, False
    ordered = weighted(listed.none_beside, sorted([law, *listed.evidence], key=lambda one: one.bic))
    return replace(listed, evidence=tuple(ordered), none_weight=1 - sum(one.weight for one in ordered)), False


def is_law(one: Evidence) -> bool:
    """Whether it is the law and not a name."""
    return is_penalised(one.score.candidate.effect)


def _in_doubt(named: Evidence, score: Score) -> bool:
    """Whether a curve may fit as well as a named effect; what is left for another reason than noise is no doubt."""
    return noise_explains(named.fit, named.remainder.noise) and _expected(named, score) <= named.bic + ALIKE


def _expected(named: Evidence, score: Score) -> float:
    """About what the BIC of the law will be, from what its best variant would take up beside the named effect."""
    found = named.fit
    test = _sized(found, score.signature.placed, tangent_space(found), found.residual)
    return named.bic - test[0] + 2 * float(np.log(len(score.candidate.signatures)))


def _searched(base: Fit, score: Score) -> float:
    return float(np.log(base.rows.count) + 2 * np.log(len(score.candidate.signatures)))


def _evidence(base: Fit, score: Score, found: LawFit) -> Evidence:
    model = SmoothRemainder(base)
    remainder = model.of(found.fit)
    count = effective_count(found.fit.rows, found.fit.residual)
    explained = (base.cost - found.cost) * count / base.rows.count
    price = found.log_determinant + _searched(base, score)
    beside = remainder.cost + remainder.hyperparameters * float(np.log(base.rows.count))
    return Evidence(
        replace(score, best=found.variant),
        found.fit,
        remainder,
        explained,
        max(round(found.freedom), 1),
        float(base.cost - explained + price),
        float(min(remainder.immaterial, beside) + price),
        explained_share(base, found.fit, remainder.noise),
    )


def fitted_law(base: Fit, score: Score) -> LawFit | None:
    """The law with θ: its place the one whose likelihood ratio is largest, or that which then fits best of those near.

    Where much more than noise is missing the measured output in the law says where it acts and how it begins, as for
    any strong effect (`measured_fit`); then the steady periods are simulated. The size τ of the penalty is that of the
    restricted likelihood at the fit. None where no steady state is found.
    """
    variants = [one.placed for one in score.candidate.signatures]
    follows = much_is_missing(base)
    around = measured_fit(base.model, base.rows) if follows else base
    space = tangent_space(around)
    tests = [_sized(around, one, space, around.residual) for one in variants]
    most = max(ratio for ratio, _, _ in tests)
    ordered = sorted(range(len(tests)), key=lambda i: -tests[i][0])
    found: list[LawFit] = []
    for i in [i for i in ordered if tests[i][0] > NEAR * most and tests[i][1] > 0][:TRIED]:
        one = _settled(base, variants[i], i, tests[i][1], follows)
        if one is not None:
            found.append(one)
    return min(found, key=lambda one: one.cost + one.log_determinant, default=None)


def _settled(base: Fit, one: PlacedEffect, variant: int, size: float, follows: bool) -> LawFit | None:
    """Fit and size of the penalty in turns."""
    model = base.model.plus(_with_size(one, size))
    starts = [replace(base, model=model)]
    starts = [measured_fit(model, base.rows), *starts] if follows else starts
    found = next((begun for start in starts if (begun := _fitted(start)) is not None), None)
    for _ in range(ROUNDS if found is not None else 0):
        assert found is not None
        size = _size_at(found)[1]
        last = found.model.effects[-1]
        if size == 0 or abs(np.log(size / _size(last))) < SETTLED:
            break
        model = replace(found.model, effects=(*base.model.effects, _with_size(last, size)), joint_covariance=None)
        found = _fitted(replace(found, model=model)) or found
    return None if found is None else LawFit(found, variant, _size_at(found)[0])


def _fitted(start: Fit) -> Fit | None:
    """From a model and signals to the minimum; None where no steady state is found or the motion runs away."""
    try:
        return fit(start.model, start.rows, iterations=ITERATIONS, tolerance=0.05, start=start.flows)
    except (NoSteadyStateError, np.linalg.LinAlgError):
        return None


def _with_size(one: PlacedEffect, size: float) -> PlacedEffect:
    return replace(one, effect=replace(one.effect, size=size))  # type: ignore[call-arg]


def _size(one: PlacedEffect) -> float:
    return float(one.effect.precision().max() ** -0.5)


def _size_at(found: Fit) -> tuple[CurveTest, float]:
    """The test and τ at a fit, from r + Σ e_i ∂Ŷ/∂e_i."""
    last = found.model.effects[-1]
    others, own = found.tangents[: -last.size], found.tangents[-last.size :]
    space = np.ascontiguousarray(orthonormal(others.T).T)
    _, size, test = _sized(found, last, space, found.residual + last.parameters() @ own)
    return test, size


def _sized(around: Fit, one: PlacedEffect, space: FloatArray, working: FloatArray) -> tuple[float, float, CurveTest]:
    """−2 ln LR, τ and the test of a law for a working residual (R,)."""
    signature = signature_of(around, one, space)
    if signature is None:
        return 0.0, 0.0, CurveTest(np.zeros((0, 1)), np.zeros(0))
    test = CurveTest.of(signature)
    onto = signature.basis @ working
    scale = 1.0 if around.rows.scaled else _noise(around, space, onto, working)
    return *test.size(onto / scale), test


def _noise(around: Fit, space: FloatArray, onto: FloatArray, working: FloatArray) -> float:
    """The size of the noise where it is not known: of what neither θ nor the law takes up."""
    outside = working - (space @ working) @ space
    left = float(outside @ outside) - float(onto @ onto)
    return float(np.sqrt(max(left, np.finfo(float).tiny) / max(around.rows.count - len(space) - len(onto), 1)))
