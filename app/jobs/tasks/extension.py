"""Adds a physical effect to a model: θ and all its effects are fitted together."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from app.conversion.channels import channels_of
from app.conversion.effects import effect_of, extended_model
from app.conversion.experiments import held_out_batches, kept_batches
from app.conversion.extremes import require_finite, within_doubles
from app.conversion.fields import field_named
from app.conversion.models import test_documents
from app.conversion.versions import version_document
from app.jobs.task import TaskContext, TaskResult
from app.schemas.extensions import ExtensionRequest
from app.schemas.models import ErrorsDocument, ExtensionReport, Model
from app.schemas.plants import Plant
from identification.comparison.batch import Batch
from identification.diagnosis.diagnose import misfit, rows_of
from identification.diagnosis.evidence import refit_short_list
from identification.diagnosis.scores import score_tests
from identification.diagnosis.signatures import candidates
from identification.diagnosis.staircase import refined, relative_error
from identification.effects.second_variable import SecondVariable, with_logged
from identification.errors import MisuseError
from identification.extension.fit import Fit, fit
from identification.models.model import Model as LpvModel
from identification.places.place import Effect

KIND = "extension"
FIELDS = {"effects": "/effect"}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The parent fitted to the experiments, the effect added, the errors of both."""
    request = ExtensionRequest.model_validate(payload["request"])
    parent = Model.model_validate(payload["model"])
    plant = Plant.model_validate(payload["plant"])
    model, channels = extended_model(parent, plant), channels_of(plant)
    held_out = held_out_batches(payload["heldOut"], context.arrays, request.mean_value, model, channels)
    with field_named(FIELDS, "/experimentIds"), within_doubles():
        batches = kept_batches(payload["experiments"], context.arrays, request.mean_value, channels)
        context.progress(0.2, "the model without the effect")
        base = fit(model, rows_of(model, batches))
        context.progress(0.4, "the model with the effect")
        grown = _grown(model, base, _effect(request, payload["quantity"], batches), request)
        require_finite(grown.model)
        report = ExtensionReport(
            diagnosis_id=request.diagnosis_id,
            held_out_experiment_ids=list(request.held_out_experiment_ids),
            before=_errors(base, batches, held_out),
            after=_errors(grown, batches, held_out),
        )
        document = version_document(parent, parent.id, grown, payload["request"], report)
    return TaskResult(document)


def _effect(request: ExtensionRequest, quantity: str | None, batches: Sequence[Batch]) -> Effect:
    effect = effect_of(request.effect)
    assert effect is not None, "checked when the job was submitted"
    of_quantities = with_logged([effect], batches)
    return next((one for one in of_quantities if isinstance(one, SecondVariable) and one.quantity == quantity), effect)


def _grown(model: LpvModel, base: Fit, effect: Effect, request: ExtensionRequest) -> Fit:
    """The effect from its best score, fitted with everything else; raises MisuseError when these data have no room."""
    judged = candidates(base, [effect], request.amplitude_degree)
    if not judged[0].signatures:
        raise MisuseError(f"{effect.title}: {judged[0].why_not}", "effects")
    scores = score_tests(base, judged, np.random.default_rng(request.seed))
    refitted = refit_short_list(base, scores, origin=model).evidence
    if not refitted:
        raise MisuseError(
            f"{effect.title}: fitted to these experiments it explains nothing or leaves its physical range; it is not"
            " what is missing",
            "effects",
        )
    return refined(refitted[0].fit)


def _errors(found: Fit, batches: Sequence[Batch], held_out: Sequence[Batch]) -> ErrorsDocument:
    return ErrorsDocument(
        fitted=relative_error(found.model, batches),
        held_out=relative_error(found.model, held_out) if held_out else None,
        lack_of_fit=test_documents((misfit("lack of fit", found),))[0],
    )
