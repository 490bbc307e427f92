"""Diagnoses: asked for, and made in a job."""

from collections.abc import Sequence
from typing import Any

from app.container import Container
from app.conversion.channels import channels_of, foreign
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.comparisons import Comparison
from app.schemas.diagnoses import Diagnosis, DiagnosisList, DiagnosisRequest
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.services.comparisons import comparison_of
from app.services.documents import fields, items, named
from app.services.jobs import fingerprint
from app.services.measured import (
    Measured,
    check_effect,
    check_logged,
    check_time_domain,
    measured_of_plant,
    payload_of,
)
from app.services.models import model_of
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "diagnoses"


def submit(container: Container, request: DiagnosisRequest, key: str | None) -> JobRecord:
    """Start the job that looks for what a model lacks."""
    resources = container.resources
    model_id, identifiers, pointer = _source(resources, request)
    model = model_of(named(resources, "models", model_id, "/modelId"))
    plant = plant_of(resources.get("plants", model.plant_id))
    experiments = measured_of_plant(resources, identifiers, plant.id, pointer)
    task = payload(plant, model, request, experiments, pointer)
    mark = fingerprint("createDiagnosis", request.model_dump(mode="json"))
    return container.ledger.submit("diagnosis", task, KIND, plant.id, key, mark)


def payload(
    plant: Plant, model: Model, request: DiagnosisRequest, experiments: list[Measured], pointer: str = "/experimentIds"
) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when experiments, model and effects do not fit each other."""
    check_time_domain(model, experiments, pointer)
    check_logged(model, experiments, pointer)
    check_effects(request.effects or [], plant, experiments)
    why = foreign(request.domain or "", channels_of(plant))
    if why:
        raise UnprocessableError.at("/domain", why)
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "request": request.as_json(),
        "experiments": payload_of(experiments),
        "pointer": pointer,
    }


def check_effects(kinds: Sequence[str], plant: Plant, experiments: list[Measured]) -> None:
    """Raises UnprocessableError unless each effect is known, named once, and such that the experiments can show it."""
    if len(set(kinds)) < len(kinds):
        raise UnprocessableError.at("/effects", "the same effect is named twice")
    for i, kind in enumerate(kinds):
        check_effect(kind, plant, experiments, f"/effects/{i}")


def _source(resources: ResourceRepository, request: DiagnosisRequest) -> tuple[str, list[str], str]:
    """The model, the experiments, and the field that they were named by."""
    if request.comparison_id is None:
        assert request.model_id is not None, "checked by the schema"
        return request.model_id, list(request.experiment_ids or ()), "/experimentIds"
    comparison = comparison_of(named(resources, "comparisons", request.comparison_id, "/comparisonId"))
    if request.experiment_ids is not None:
        return comparison.model_id, list(request.experiment_ids), "/experimentIds"
    return comparison.model_id, _judged_by(comparison), "/comparisonId"


def _judged_by(comparison: Comparison) -> list[str]:
    still = [one for one in comparison.experiments if one.operating_point is not None]
    if not still:
        raise UnprocessableError.at(
            "/comparisonId",
            "the scheduling varied in all experiments of this comparison; the library knows the shape of effects at"
            " operating points that are held still: name such experiments in experimentIds",
        )
    fitted = [one.experiment_id for one in still if one.data == "fitted"]
    return fitted or [one.experiment_id for one in still]


def diagnosis_of(resource: Resource) -> Diagnosis:
    """The diagnosis in a row."""
    return Diagnosis.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, diagnosis_id: str) -> Diagnosis:
    """The diagnosis of an identifier."""
    return diagnosis_of(resources.get(KIND, diagnosis_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> DiagnosisList:
    """Part of the list of diagnoses."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return DiagnosisList(items=items(found, diagnosis_of), next_cursor=found.next_cursor)
