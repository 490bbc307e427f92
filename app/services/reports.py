"""Reports: asked for, and drawn in a job."""

from typing import Any

from app.container import Container
from app.jobs.records import JobRecord
from app.schemas.reports import Report, ReportList, ReportRequest
from app.services.comparisons import comparison_of
from app.services.designs import design_of
from app.services.diagnoses import diagnosis_of
from app.services.documents import fields, items
from app.services.experiments import experiment_of
from app.services.histories import History, history
from app.services.jobs import fingerprint
from app.services.models import model_of
from app.services.plants import plant_of
from app.services.signals import signals_of
from app.store.resources import Resource, ResourceRepository

KIND = "reports"


def submit(container: Container, model_id: str, request: ReportRequest, key: str | None) -> JobRecord:
    """Start the job that draws the report of a model."""
    resources = container.resources
    row = resources.get("models", model_id)
    plant = plant_of(resources.get("plants", row.plant_id or ""))
    task = payload(history(resources, row)) | {"plant": plant.as_json(), "request": request.as_json()}
    mark = fingerprint("createReport", model_id, request.model_dump(mode="json"))
    return container.ledger.submit("report", task, KIND, plant.id, key, mark)


def payload(found: History) -> dict[str, Any]:
    """What the task gets of a history."""
    return {
        "versions": [model_of(row).as_json() for row in found.versions],
        "experiments": [{"document": experiment_of(row).as_json(), "arrays": row.arrays} for row in found.experiments],
        "designs": [design_of(row).as_json() for row in found.designs],
        "comparisons": [{"document": comparison_of(row).as_json(), "arrays": row.arrays} for row in found.comparisons],
        "diagnoses": [diagnosis_of(row).as_json() for row in found.diagnoses],
        "signals": [{"document": signals_of(row).as_json(), "arrays": row.arrays} for row in found.signals],
    }


def report_of(resource: Resource) -> Report:
    """The report in a row."""
    return Report.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, report_id: str) -> Report:
    """The report of an identifier."""
    return report_of(resources.get(KIND, report_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> ReportList:
    """Part of the list of reports."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return ReportList(items=items(found, report_of), next_cursor=found.next_cursor)


def as_file(container: Container, report_id: str) -> bytes:
    """The page itself."""
    resource = container.resources.get(KIND, report_id)
    return container.arrays.get(resource.arrays or "")["html"].tobytes()
