"""Diagnoses: what was found, to documents."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from app.arrays import ComplexVector
from app.conversion.channels import NAMES
from app.conversion.effects import effect_documents, parameters_of, quantity_of
from app.conversion.models import outcome_document, test_documents
from app.schemas.comparisons import NoteDocument
from app.schemas.diagnoses import (
    EffectVisibility,
    Evidence,
    ExplainedResponse,
    MissingResponse,
    RankedEffect,
    VariationDocument,
    Verdict,
)
from app.schemas.effects import PlacedEffectDocument
from app.schemas.experiments import Experiment
from app.schemas.quantities import QuantityName
from identification.channels import UNSTATED, Channel, Channels
from identification.diagnosis import evidence as refits
from identification.diagnosis.diagnose import Diagnosis, Visibility
from identification.diagnosis.missing import explained_response, missing_response
from identification.diagnosis.readings import reading
from identification.diagnosis.scores import Score
from identification.diagnosis.variances import Variation

LAID_OVER = 3
VERDICTS: dict[str, Verdict] = {
    "nothing missing": "nothingMissing",
    "explained": "explained",
    "partly explained": "partlyExplained",
    "not in the library": "notInTheLibrary",
    "cannot be judged": "cannotBeJudged",
}


def findings(found: Diagnosis, experiments: Sequence[Experiment]) -> dict[str, Any]:
    """What a diagnosis found, as the fields of its document."""
    order = _order(found)
    ranking = [_ranked(found, found.scores[i]) for i in order]
    before, remaining = test_documents((found.lack_of_fit, found.remaining))
    return {
        "inputQuantity": _name(_channels(found).input),
        "outputQuantity": _name(_channels(found).output),
        "verdict": VERDICTS[found.verdict],
        "reason": found.reason,
        "restBefore": found.rest_before,
        "restAfter": found.rest_after,
        "noneOfTheseWeight": found.none_weight,
        "variations": [_variation(one, found.variation).as_json() for one in _variations(found)],
        "notes": [NoteDocument(experiment_id=experiments[m].id, text=text).as_json() for m, text in found.notes],
        "confident": bool(found.confident),
        "announced": [one.score.candidate.effect.kind for one in found.announced],
        "lackOfFit": before.as_json(),
        "remaining": remaining.as_json(),
        "explainedShare": found.explained_share,
        "ranking": [one.as_json() for one in ranking],
        "confusability": found.confusability[np.ix_(order, order)].tolist(),
        "visibility": [_visibility(one).as_json() for one in found.visibility],
        "missing": [one.as_json() for one in _missing(found, experiments)],
    }


def _channels(found: Diagnosis) -> Channels:
    return found.base.flows[0].batch.channels if found.base.flows else UNSTATED


def _name(channel: Channel) -> QuantityName | None:
    return None if channel.quantity is None else NAMES[channel.quantity]


def _order(found: Diagnosis) -> list[int]:
    """Places in `scores`: refitted effects by BIC, then the others by adjusted p."""
    refitted = [next(i for i, s in enumerate(found.scores) if s is one.score) for one in found.evidence]
    return refitted + [i for i in range(len(found.scores)) if i not in refitted]


def _ranked(found: Diagnosis, score: Score) -> RankedEffect:
    effect = score.signature.placed.effect
    refit = next((one for one in found.evidence if one.score is score), None)
    return RankedEffect(
        kind=effect.kind,
        title=effect.title,
        place=effect.place,
        unit=effect.unit,
        quantity=quantity_of(effect),
        reading=reading(effect, _channels(found)),
        announced=any(one.score is score for one in found.announced),
        parameters=parameters_of(effect),
        score=float(score.statistic),
        p_value=float(score.p_value),
        adjusted_p_value=float(score.adjusted_p),
        evidence=None if refit is None else _evidence(refit),
    )


def _evidence(one: refits.Evidence) -> Evidence:
    return Evidence(
        effect=_without_interval(one),
        bic=one.bic,
        weight=one.weight,
        share=one.share,
        at_bound=one.at_bound,
        chi_square_explained=float(one.explained),
        added_parameters=one.parameters,
        chi_square_per_parameter=float(one.explained_per_parameter),
        outcome=outcome_document(one.fit.outcome),
    )


def _without_interval(one: refits.Evidence) -> PlacedEffectDocument:
    """The effect as fitted; on a bound of its range it has no interval."""
    found = effect_documents(one.fit.model)[-1]
    if not one.at_bound:
        return found
    parameters = [each.model_copy(update={"standard_deviation": None}) for each in found.parameters]
    return found.model_copy(update={"standard_deviations": None, "parameters": parameters})


def _variations(found: Diagnosis) -> list[Variation]:
    return [*([] if found.variation is None else [found.variation]), *found.variations]


def _variation(one: Variation, chosen: Variation | None) -> VariationDocument:
    return VariationDocument(
        kind=one.effect.kind,
        title=one.effect.title,
        unit=one.effect.unit,
        size=one.size,
        p_value=one.p_value,
        explains=one is chosen,
        advice=one.effect.advice,
    )


def _visibility(one: Visibility) -> EffectVisibility:
    return EffectVisibility(
        kind=one.effect.kind,
        title=one.effect.title,
        quantity=quantity_of(one.effect),
        status="visible" if one.amplitude is not None else "invisible" if one.judged else "notJudged",
        detectable_amplitude=one.amplitude,
        kept=float(one.kept),
        reason=one.reason,
    )


def _missing(found: Diagnosis, experiments: Sequence[Experiment]) -> list[MissingResponse]:
    """One an experiment, where the kernel meets excited lines."""
    rows: dict[int, MissingResponse] = {}
    best = found.evidence[:LAID_OVER]
    explained = [explained_response(found.base, one.fit) for one in best]
    for t, table in enumerate(missing_response(found.base)):
        for m, member in enumerate(table.members):
            seen = np.isfinite(table.response[m]) & np.isfinite(table.deviation[m])
            parts = zip(best, (tables[t].response[m, seen] for tables in explained), strict=True)
            rows[int(member)] = MissingResponse(
                experiment_id=experiments[int(member)].id,
                operating_point=experiments[int(member)].held_at,
                frequencies_rad_per_second=table.frequencies[seen].tolist(),
                response=ComplexVector.of(table.response[m, seen]),
                standard_deviation=table.deviation[m, seen].tolist(),
                explained=[
                    ExplainedResponse(kind=one.fit.model.effects[-1].effect.kind, response=ComplexVector.of(part))
                    for one, part in parts
                ],
            )
    return [rows[i] for i in sorted(rows)]
