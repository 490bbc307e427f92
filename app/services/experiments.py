"""Experiments: data that came in is kept as it came, and a job makes out what it is."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.container import Container
from app.conversion.experiments import requested_measurement, require_channels
from app.conversion.misuse import pointing
from app.conversion.plants import channels, plant_dependence
from app.errors import UnprocessableError
from app.files.measurement import measurement_arrays
from app.jobs.records import JobRecord
from app.schemas.experiments import Experiment, ExperimentList, ExperimentRequest, FileFields
from app.schemas.plants import Plant
from app.services.documents import fields, items, named, of_plant
from app.services.jobs import fingerprint
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "experiments"
Arrays = dict[str, NDArray[Any]]
ARRAYS_OF_BODY = {"input", "output", "frequencies_rad_per_second", "response", "variance"}
POINTERS = {
    "input": "/input",
    "output": "/output",
    "sample_time": "/sampleTimeSeconds",
    "period": "/periodSamples",
    "frequencies": "/frequenciesRadPerSecond",
    "response": "/response",
    "variance": "/variance",
}


def submit(container: Container, request: ExperimentRequest, key: str | None) -> JobRecord:
    """Start the job that looks at measured arrays."""
    plant = _plant_with_point(container.resources, request.root)
    payload, arrays = json_payload(plant, request)
    payload["arrays"] = container.arrays.put(arrays)
    return _submit(container, plant, payload, key)


def submit_file(container: Container, request: FileFields, content: bytes, name: str, key: str | None) -> JobRecord:
    """Start the job that reads a file of measurements."""
    plant = _plant_with_point(container.resources, request)
    payload, arrays = file_payload(plant, request, content, name)
    payload["arrays"] = container.arrays.put(arrays)
    return _submit(container, plant, payload, key)


def json_payload(plant: Plant, request: ExperimentRequest) -> tuple[dict[str, Any], Arrays]:
    """What the task gets beside the hash of the arrays, and the arrays."""
    with pointing(POINTERS, default=""):
        data = requested_measurement(request.root)
        require_channels(data, channels(plant))
    stated = request.root.model_dump(by_alias=True, mode="json", exclude=ARRAYS_OF_BODY)
    return _task("json", None, stated, plant), measurement_arrays(data)


def file_payload(plant: Plant, request: FileFields, content: bytes, name: str) -> tuple[dict[str, Any], Arrays]:
    """What the task gets beside the hash of the file, and the file as an array of bytes."""
    if not content:
        raise UnprocessableError.at("/file", "the file is empty")
    stated = request.as_json()
    return _task(file_format(name), name[:200], stated, plant), {"file": np.frombuffer(content, dtype=np.uint8)}


def file_format(name: str) -> Literal["csv", "npz", "mat"]:
    """The format of a file by the end of its name."""
    for ending in ("csv", "npz", "mat"):
        if name.lower().endswith(f".{ending}"):
            return ending
    if name.lower().endswith((".txt", ".tsv")):
        return "csv"
    raise UnprocessableError.at("/file", "the name of the file must end in .csv, .npz or .mat")


def _task(source: str, file_name: str | None, stated: dict[str, Any], plant: Plant) -> dict[str, Any]:
    return {"source": source, "fileName": file_name, "stated": stated, "channels": list(channels(plant))}


def experiment_of(resource: Resource) -> Experiment:
    """The experiment in a row."""
    return Experiment.model_validate(fields(resource, "jobId"))


def get(resources: ResourceRepository, experiment_id: str) -> Experiment:
    """The experiment of an identifier."""
    return experiment_of(resources.get(KIND, experiment_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> ExperimentList:
    """Part of the list of experiments."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return ExperimentList(items=items(found, experiment_of), next_cursor=found.next_cursor)


def _plant_with_point(resources: ResourceRepository, request: Any) -> Plant:
    plant = plant_of(named(resources, "plants", request.plant_id, "/plantId"))
    with pointing({}, default="/operatingPoint"):
        plant_dependence(plant).points([request.operating_point])
    if request.design_id is not None:
        of_plant(named(resources, "designs", request.design_id, "/designId"), plant.id, "/designId")
    return plant


def _submit(container: Container, plant: Plant, payload: dict[str, Any], key: str | None) -> JobRecord:
    mark = fingerprint("createExperiment", payload)
    return container.ledger.submit("experiment", payload, KIND, plant.id, key, mark)
