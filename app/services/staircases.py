"""Staircases: asked for, and made in a job together with their versions and diagnoses."""

from typing import Any

from app.container import Container
from app.jobs.records import JobRecord
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.schemas.staircases import Staircase, StaircaseList, StaircaseRequest
from app.services.diagnoses import check_effects
from app.services.documents import fields, items
from app.services.extensions import HELD_OUT, check_has_coefficients, check_measured
from app.services.jobs import fingerprint
from app.services.measured import Measured, fitted_experiments, measured_of_plant, payload_of
from app.services.models import model_of
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "staircases"


def submit(container: Container, model_id: str, request: StaircaseRequest, key: str | None) -> JobRecord:
    """Start the job that adds effects until noise explains what is left."""
    resources = container.resources
    model = model_of(resources.get("models", model_id))
    plant = plant_of(resources.get("plants", model.plant_id))
    experiments = measured_of_plant(resources, request.experiment_ids, plant.id, "/experimentIds")
    held_out = measured_of_plant(resources, request.held_out_experiment_ids, plant.id, HELD_OUT)
    check_measured(model, experiments, held_out, fitted_experiments(resources, model))
    check_effects(request.effects or [], plant, [*experiments, *held_out])
    for i, kind in enumerate(request.effects or []):
        check_has_coefficients(model, kind, f"/effects/{i}")
    mark = fingerprint("createStaircase", model_id, request.model_dump(mode="json"))
    task = _payload(plant, model, request, experiments, held_out)
    return container.ledger.submit("staircase", task, KIND, plant.id, key, mark)


def _payload(
    plant: Plant, model: Model, request: StaircaseRequest, experiments: list[Measured], held_out: list[Measured]
) -> dict[str, Any]:
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "request": request.as_json(),
        "experiments": payload_of(experiments),
        "heldOut": payload_of(held_out),
    }


def staircase_of(resource: Resource) -> Staircase:
    """The staircase in a row."""
    return Staircase.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, staircase_id: str) -> Staircase:
    """The staircase of an identifier."""
    return staircase_of(resources.get(KIND, staircase_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> StaircaseList:
    """Part of the list of staircases."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return StaircaseList(items=items(found, staircase_of), next_cursor=found.next_cursor)
