"""Reports: one page of all that led to a model."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.routers.downloads import file_answer, file_response
from app.schemas.jobs import Job
from app.schemas.reports import Report, ReportList, ReportRequest
from app.services import reports
from app.services.jobs import accepted

router = APIRouter(tags=["reports"])


@router.post("/models/{modelId}/reports", status_code=202)
def create_report(
    modelId: str,
    body: ReportRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Draw all that led to a model: experiments, design, versions, comparisons, diagnoses, and how the error fell."""
    return accepted(reports.submit(container, modelId, body, key), response)


@router.get("/reports")
def list_reports(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> ReportList:
    """Reports, newest first."""
    return reports.page(resources, plant_id, limit, cursor)


@router.get("/reports/{reportId}")
def get_report(reportId: str, resources: ResourcesDependency) -> Report:
    """One report: what it was made from."""
    return reports.get(resources, reportId)


@router.get("/reports/{reportId}/file", response_class=Response, responses=file_answer("html"))
def get_report_file(reportId: str, container: ContainerDependency) -> Response:
    """The page, one HTML file that needs no network."""
    return file_response(reports.as_file(container, reportId), f"report-{reportId}", "html")
