"""Previews of files: a job looks into the file, and nothing is made of it."""

from typing import Any

from app.container import Container
from app.jobs.records import JobRecord
from app.schemas.experiments import FileFields
from app.schemas.previews import Preview
from app.services.documents import fields, named
from app.services.experiments import KIND as EXPERIMENTS
from app.services.experiments import file_payload
from app.services.jobs import fingerprint
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "previews"
LOOKED_BACK = 50


def submit(container: Container, request: FileFields, content: bytes, name: str, key: str | None) -> JobRecord:
    """Start the job that looks into a file."""
    plant = plant_of(named(container.resources, "plants", request.plant_id, "/plantId"))
    still = request.model_copy(update={"operating_point": None, "operating_point_columns": None})
    payload, arrays = file_payload(plant, still, content, name)
    payload["stated"] = request.as_json()
    payload["remembered"] = _remembered(container.resources, plant.id)
    payload["arrays"] = container.arrays.put(arrays)
    return container.ledger.submit("preview", payload, KIND, plant.id, key, fingerprint("previewFile", payload))


def _remembered(resources: ResourceRepository, plant_id: str) -> dict[str, Any]:
    """What was stated of the columns of the plant's newest file with statements."""
    for row in resources.list(EXPERIMENTS, plant_id, LOOKED_BACK).items:
        if row.document.get("columns") or row.document.get("units"):
            return {name: row.document.get(name, []) for name in ("columns", "units")}
    return {"columns": [], "units": []}


def preview_of(resource: Resource) -> Preview:
    """The preview in a row."""
    return Preview.model_validate(fields(resource, "jobId"))


def get(resources: ResourceRepository, preview_id: str) -> Preview:
    """The preview of an identifier."""
    return preview_of(resources.get(KIND, preview_id))
