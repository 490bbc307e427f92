"""Models from experiments in which the scheduling varies: checked, and identified in a job."""

from collections.abc import Sequence
from typing import Any

from app.container import Container
from app.conversion.misuse import pointing
from app.conversion.plants import channels, product_basis
from app.conversion.varying_models import requested_basis, requested_structure
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.experiments import Experiment
from app.schemas.plants import Plant
from app.schemas.varying import VaryingModelRequest
from app.services.documents import named, named_of_plant, of_plant
from app.services.experiments import experiment_of
from app.services.fitting import check_sample_time
from app.services.jobs import fingerprint
from app.services.models import KIND
from app.services.plants import plant_of
from identification.varying.stacks import StackSizes

TASK = "varying_identification"
MOST_ENTRIES = 500
Given = tuple[Experiment, str]


def submit(container: Container, request: VaryingModelRequest, key: str | None) -> JobRecord:
    """Start the job that identifies a model from a record along varying scheduling."""
    resources = container.resources
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    wanted = [request.experiment_id, *request.held_out_experiment_ids]
    if len(set(wanted)) < len(wanted):
        raise UnprocessableError.at("/heldOutExperimentIds", "an experiment is named twice, or fitted and held out")
    row = named(resources, "experiments", request.experiment_id, "/experimentId")
    fitted = of_plant(row, plant.id, "/experimentId")
    held_out = named_of_plant(resources, "experiments", wanted[1:], plant.id, "/heldOutExperimentIds")
    experiments = [(experiment_of(row), row.arrays or "") for row in (fitted, *held_out)]
    task = payload(plant, request, experiments[0], experiments[1:])
    sent = {name: value for name, value in request.asked().items() if (name, value) != ("basis", None)}
    mark = fingerprint("createVaryingModel", sent)
    return container.ledger.submit(TASK, task, KIND, plant.id, key, mark)


def payload(plant: Plant, request: VaryingModelRequest, fitted: Given, held_out: Sequence[Given]) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when experiments and structure do not fit."""
    with pointing({"basis": "/basis"}, default="/structure"):
        structure = requested_structure(plant, request)
        functions = product_basis(requested_basis(plant, request)).size
    n_y, n_u = channels(plant)
    size = StackSizes(structure.order or 1, functions, n_u, n_y).size
    if size > MOST_ENTRIES:
        raise UnprocessableError.at(
            "/structure",
            f"the matrices have {size} entries, at most {MOST_ENTRIES} are estimated; choose a lower order",
        )
    _check(fitted[0], structure.sample_time_seconds, "/experimentId")
    for i, (experiment, _) in enumerate(held_out):
        _check(experiment, structure.sample_time_seconds, f"/heldOutExperimentIds/{i}")
    return {
        "plant": plant.as_json(),
        "request": request.as_json(),
        "experiment": _given(fitted),
        "heldOut": [_given(one) for one in held_out],
    }


def _given(one: Given) -> dict[str, Any]:
    return {"document": one[0].as_json(), "arrays": one[1]}


def _check(experiment: Experiment, sample_time: float, pointer: str) -> None:
    if experiment.kind != "varyingRecord":
        raise UnprocessableError.at(
            pointer,
            "the operating point was held still in this experiment; give a record along varying scheduling, or identify"
            " with another kind of POST /v1/models",
        )
    check_sample_time(experiment, sample_time, pointer)
