"""Extensions: a new version of a model with one effect more, made in a job."""

from collections.abc import Set
from typing import Any

from app.container import Container
from app.conversion.effects import effect_of
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.extensions import ExtensionRequest
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.services.diagnoses import diagnosis_of
from app.services.documents import named, of_plant
from app.services.jobs import fingerprint
from app.services.measured import (
    Measured,
    check_effect,
    check_logged,
    check_time_domain,
    chosen_quantity,
    fitted_experiments,
    measured_of_plant,
    payload_of,
)
from app.services.models import KIND, model_of
from app.services.plants import plant_of
from app.store.resources import ResourceRepository
from identification.places.linear import Coefficient

HELD_OUT = "/heldOutExperimentIds"
OF_COEFFICIENTS = (
    "this effect changes single coefficients, and those of a state-space model depend on the state basis; identify a"
    " rational model from these experiments and extend that"
)


def submit(container: Container, model_id: str, request: ExtensionRequest, key: str | None) -> JobRecord:
    """Start the job that adds an effect to a model."""
    resources = container.resources
    model = model_of(resources.get(KIND, model_id))
    plant = plant_of(resources.get("plants", model.plant_id))
    experiments = measured_of_plant(resources, request.experiment_ids, plant.id, "/experimentIds")
    held_out = measured_of_plant(resources, request.held_out_experiment_ids, plant.id, HELD_OUT)
    _check_diagnosis(resources, model, request)
    task = payload(plant, model, request, experiments, held_out, fitted_experiments(resources, model))
    mark = fingerprint("createExtension", model_id, request.model_dump(mode="json"))
    return container.ledger.submit("extension", task, KIND, plant.id, key, mark)


def payload(
    plant: Plant,
    model: Model,
    request: ExtensionRequest,
    experiments: list[Measured],
    held_out: list[Measured],
    fitted: Set[str],
) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when the effect or the experiments do not fit the model."""
    check_effect(request.effect, plant, [*experiments, *held_out], "/effect")
    check_has_coefficients(model, request.effect, "/effect")
    check_measured(model, experiments, held_out, fitted)
    quantity = chosen_quantity(request.effect, request.quantity, [*experiments, *held_out])
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "request": request.as_json(),
        "experiments": payload_of(experiments),
        "heldOut": payload_of(held_out),
        "quantity": quantity,
    }


def check_has_coefficients(model: Model, kind: str, pointer: str) -> None:
    """Raises UnprocessableError for an effect on coefficients that a model from varying scheduling does not have."""
    if model.varying is not None and isinstance(effect_of(kind), Coefficient):
        raise UnprocessableError.at(pointer, OF_COEFFICIENTS)


def check_measured(model: Model, experiments: list[Measured], held_out: list[Measured], fitted: Set[str]) -> None:
    """Raises UnprocessableError when experiments do not fit the model, or held-out ones are or were fitted."""
    check_time_domain(model, experiments, "/experimentIds")
    check_time_domain(model, held_out, HELD_OUT)
    check_logged(model, experiments, "/experimentIds")
    check_logged(model, held_out, HELD_OUT)
    known = fitted | {experiment.id for experiment, _ in experiments}
    for i, (experiment, _) in enumerate(held_out):
        if experiment.id in known:
            raise UnprocessableError.at(
                f"{HELD_OUT}/{i}", "this experiment is or was fitted, so its error would say nothing; leave it out"
            )


def _check_diagnosis(resources: ResourceRepository, model: Model, request: ExtensionRequest) -> None:
    if request.diagnosis_id is None:
        return
    row = of_plant(named(resources, "diagnoses", request.diagnosis_id, "/diagnosisId"), model.plant_id, "/diagnosisId")
    diagnosed = diagnosis_of(row).model_id
    if diagnosed != model.id:
        raise UnprocessableError.at("/diagnosisId", f"it is a diagnosis of another model, {diagnosed}")
