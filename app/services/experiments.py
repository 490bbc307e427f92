"""Experiments: data that came in is kept as it came, and a job makes out what it is."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.container import Container
from app.conversion.experiments import requested_measurement, require_channels
from app.conversion.misuse import pointing
from app.conversion.plants import channels, plant_dependence
from app.conversion.varying_records import record_arrays, requested_record
from app.errors import UnprocessableError
from app.files.measurement import measurement_arrays
from app.files.readers import endings, kind_of_file
from app.jobs.records import JobRecord
from app.schemas.experiments import Experiment, ExperimentList, ExperimentRequest, FileFields, VaryingRecordRequest
from app.schemas.plants import Plant
from app.services.documents import fields, items, named, named_of_plant, of_plant
from app.services.jobs import fingerprint
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "experiments"
VARYING_POINTERS = {
    "input": "/inputs",
    "output": "/outputs",
    "scheduling": "/scheduling",
    "sample_time": "/sampleTimeSeconds",
    "period": "/periodSamples",
}
VARIED = (
    "the scheduling varied in this experiment; what it says is found with the kind varyingScheduling of POST"
    " /v1/models, here experiments at operating points that were held still are needed"
)
Arrays = dict[str, NDArray[Any]]
ARRAYS_OF_BODY = {
    *("input", "output", "frequencies_rad_per_second", "response", "variance"),
    *("inputs", "outputs", "scheduling", "reference"),
}
POINTERS = {
    "input": "/input",
    "output": "/output",
    "reference": "/reference",
    "sample_time": "/sampleTimeSeconds",
    "period": "/periodSamples",
    "frequencies": "/frequenciesRadPerSecond",
    "response": "/response",
    "variance": "/variance",
}


def submit(container: Container, request: ExperimentRequest, key: str | None) -> JobRecord:
    """Start the job that looks at measured arrays."""
    plant = _plant_of(container.resources, request.root)
    payload, arrays = json_payload(plant, request)
    payload["arrays"] = container.arrays.put(arrays)
    return _submit(container, plant, payload, key)


def submit_file(container: Container, request: FileFields, content: bytes, name: str, key: str | None) -> JobRecord:
    """Start the job that reads a file of measurements."""
    plant = _plant_of(container.resources, request)
    payload, arrays = file_payload(plant, request, content, name)
    payload["arrays"] = container.arrays.put(arrays)
    return _submit(container, plant, payload, key)


def json_payload(plant: Plant, request: ExperimentRequest) -> tuple[dict[str, Any], Arrays]:
    """What the task gets beside the hash of the arrays, and the arrays."""
    body = request.root
    stated = body.model_dump(by_alias=True, mode="json", exclude=ARRAYS_OF_BODY)
    if isinstance(body, VaryingRecordRequest):
        with pointing(VARYING_POINTERS, default=""):
            record = requested_record(plant, body)
        return {**_task("json", None, stated, plant), "plant": plant.as_json()}, record_arrays(record)
    with pointing(POINTERS, default=""):
        data = requested_measurement(body)
        require_channels(data, channels(plant))
    return _task("json", None, stated, plant), measurement_arrays(data)


def file_payload(plant: Plant, request: FileFields, content: bytes, name: str) -> tuple[dict[str, Any], Arrays]:
    """What the task gets beside the hash of the file, and the file as an array of bytes."""
    if not content:
        raise UnprocessableError.at("/file", "the file is empty")
    kind = file_kind(name, content)
    task = _task(kind, name[:200], request.as_json(), plant)
    _check_point_columns(request, plant)
    if request.operating_point is None and request.operating_point_columns is None:
        if request.stated:
            raise UnprocessableError.at(
                "/operatingPoint",
                "operating levels, hold and feedback are stated of records at an operating point held still; state it"
                " or leave them out",
            )
        task["plant"] = plant.as_json()
        columns = request.scheduling_columns
        if columns is not None and len(columns) != len(plant.scheduling_variables):
            raise UnprocessableError.at(
                "/schedulingColumns",
                f"{len(columns)} columns are named, the plant has {len(plant.scheduling_variables)} variables",
            )
    elif request.scheduling_columns is not None:
        raise UnprocessableError.at(
            "/schedulingColumns",
            "an operating point that is held still has no scheduling signals; leave one of them out",
        )
    return task, {"file": np.frombuffer(content, dtype=np.uint8)}


def _check_point_columns(request: FileFields, plant: Plant) -> None:
    names, wanted = request.operating_point_columns, len(plant.scheduling_variables)
    if names is None:
        return
    if request.scheduling_columns is not None:
        raise UnprocessableError.at("/operatingPointColumns", "the scheduling was held still or it varied; give one")
    if len(names) != wanted:
        raise UnprocessableError.at(
            "/operatingPointColumns", f"{len(names)} columns are named, the plant has {wanted} variables"
        )


def file_kind(name: str, content: bytes) -> str:
    """The kind of the reader for a file, by the end of its name and its first bytes."""
    found = kind_of_file(name, content)
    if found is None:
        known = ", ".join(f".{ending}" for ending in endings())
        raise UnprocessableError.at("/file", f"the name of the file must end in one of {known}")
    return found


def _task(source: str, file_name: str | None, stated: dict[str, Any], plant: Plant) -> dict[str, Any]:
    signals = {
        "inputs": [one.as_json() for one in (*(plant.inputs or ()), plant.input) if one is not None],
        "outputs": [one.as_json() for one in (*(plant.outputs or ()), plant.output) if one is not None],
        "variables": [one.as_json() for one in plant.scheduling_variables],
    }
    return {
        "source": source,
        "fileName": file_name,
        "stated": stated,
        "channels": list(channels(plant)),
        "signals": signals,
    }


def experiment_of(resource: Resource) -> Experiment:
    """The experiment in a row."""
    return Experiment.model_validate(fields(resource, "jobId"))


def local_experiments(
    resources: ResourceRepository, identifiers: Sequence[str], plant_id: str, pointer: str
) -> list[Resource]:
    """The experiments that a list in the body names; raises UnprocessableError where the scheduling varied."""
    rows = named_of_plant(resources, KIND, identifiers, plant_id, pointer)
    for i, row in enumerate(rows):
        if row.document["kind"] == "varyingRecord":
            raise UnprocessableError.at(f"{pointer}/{i}", VARIED)
    return rows


def get(resources: ResourceRepository, experiment_id: str) -> Experiment:
    """The experiment of an identifier."""
    return experiment_of(resources.get(KIND, experiment_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> ExperimentList:
    """Part of the list of experiments."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return ExperimentList(items=items(found, experiment_of), next_cursor=found.next_cursor)


def check_point(plant: Plant, request: Any, pointer: str = "/operatingPoint") -> None:
    """Raises UnprocessableError for an operating point outside the range; there is none where scheduling varied."""
    point = getattr(request, "operating_point", None)
    if point is not None:
        with pointing({}, default=pointer):
            plant_dependence(plant).points([point])


def _plant_of(resources: ResourceRepository, request: Any) -> Plant:
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    check_point(plant, request)
    if request.design_id is not None:
        of_plant(named(resources, "designs", request.design_id, "/designId"), plant.id, "/designId")
    return plant


def _submit(container: Container, plant: Plant, payload: dict[str, Any], key: str | None) -> JobRecord:
    mark = fingerprint("createExperiment", payload)
    return container.ledger.submit("experiment", payload, KIND, plant.id, key, mark)
