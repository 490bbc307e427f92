"""Adds effects to a model until noise explains what is left."""

from collections.abc import Sequence
from typing import Any

from app import __version__
from app.conversion.channels import channels_of
from app.conversion.diagnoses import VERDICTS, findings
from app.conversion.effects import chosen_effects, extended_model
from app.conversion.experiments import held_out_batches, kept_batches
from app.conversion.extremes import require_finite, within_doubles
from app.conversion.fields import field_named
from app.conversion.models import test_documents
from app.conversion.versions import version_document
from app.jobs.outcomes import Made
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import Experiment
from app.schemas.models import ErrorsDocument, ExtensionReport, Model
from app.schemas.plants import Plant
from app.schemas.staircases import StaircaseRequest, StaircaseStep
from app.store.identifiers import new_identifier
from identification.diagnosis.staircase import Step, conclusion, staircase
from identification.places.linear import Coefficient
from identification.places.place import Effect

KIND = "staircase"
FIELDS = {"effects": "/effects", "model": "/experimentIds"}
KEPT = ("name", "description", "seed", "experimentIds", "heldOutExperimentIds")


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Every step with its version and its diagnosis."""
    request = StaircaseRequest.model_validate(payload["request"])
    first = Model.model_validate(payload["model"])
    plant = Plant.model_validate(payload["plant"])
    model, channels = extended_model(first, plant), channels_of(plant)
    held_out = held_out_batches(payload["heldOut"], context.arrays, request.mean_value, model, channels)
    with field_named(FIELDS, "/experimentIds"), within_doubles():
        batches = kept_batches(payload["experiments"], context.arrays, request.mean_value, channels)
        context.progress(0.2, "effects one after the other")
        steps = staircase(
            model,
            batches,
            held_out,
            _effects(request, first),
            request.amplitude_degree,
            request.largest,
            request.seed,
        )
        for step in steps:
            require_finite(step.model)
        names = [first.id, *(new_identifier() for _ in steps[1:])]
        diagnoses = _diagnoses(payload, request, first, names, steps)
        versions = _versions(payload["request"], first, names, diagnoses, steps)
    document = {
        **{name: payload["request"][name] for name in KEPT},
        "softwareVersion": __version__,
        "modelId": first.id,
        "conclusion": VERDICTS[conclusion(steps)],
        "steps": [
            _step(step, name, diagnosis.identifier, step.model.effects[-1].effect.kind if i else None).as_json()
            for i, (step, name, diagnosis) in enumerate(zip(steps, names, diagnoses, strict=True))
        ],
    }
    return TaskResult(document, beside=(*versions, *diagnoses))


def _effects(request: StaircaseRequest, first: Model) -> tuple[Effect, ...]:
    """The effects asked for, without those on coefficients where these depend on the state basis."""
    asked = chosen_effects(request.effects, request.domain)
    return asked if first.varying is None else tuple(one for one in asked if not isinstance(one, Coefficient))


def _diagnoses(
    payload: dict[str, Any], request: StaircaseRequest, first: Model, names: Sequence[str], steps: Sequence[Step]
) -> list[Made]:
    """A diagnosis of every version."""
    experiments = [Experiment.model_validate(given["document"]) for given in payload["experiments"]]
    common = {
        "softwareVersion": __version__,
        "name": request.name,
        "description": request.description,
        "comparisonId": None,
        "experimentIds": list(request.experiment_ids),
        "amplitudeDegree": request.amplitude_degree,
        "meanValue": request.mean_value,
        "seed": request.seed,
    }
    return [
        Made(
            "diagnoses",
            new_identifier(),
            first.plant_id,
            {**common, "modelId": name, **findings(step.diagnosis, experiments)},
        )
        for name, step in zip(names, steps, strict=True)
    ]


def _versions(
    asked: dict[str, Any], first: Model, names: Sequence[str], diagnoses: Sequence[Made], steps: Sequence[Step]
) -> list[Made]:
    """A model for every step but the first, each the parent of the next."""
    made = []
    for i in range(1, len(steps)):
        report = ExtensionReport(
            diagnosis_id=diagnoses[i - 1].identifier,
            held_out_experiment_ids=asked["heldOutExperimentIds"],
            before=_errors(steps[i - 1]),
            after=_errors(steps[i]),
        )
        document = version_document(first, names[i - 1], steps[i].fit, asked, report)
        made.append(Made("models", names[i], first.plant_id, document))
    return made


def _errors(step: Step) -> ErrorsDocument:
    lack_of_fit = test_documents((step.diagnosis.lack_of_fit,))[0]
    return ErrorsDocument(fitted=step.error, held_out=step.held_out_error, lack_of_fit=lack_of_fit)


def _step(step: Step, model_id: str, diagnosis_id: str, added: str | None) -> StaircaseStep:
    errors = _errors(step)
    return StaircaseStep(
        model_id=model_id,
        diagnosis_id=diagnosis_id,
        added=added,
        fitted=errors.fitted,
        held_out=errors.held_out,
        lack_of_fit=errors.lack_of_fit,
    )
