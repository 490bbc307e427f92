"""Comparisons: hold a model against experiments, look where it fails."""

from typing import Annotated, Literal

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.routers.downloads import file_answer, file_response
from app.schemas.comparisons import ComparedResponse, Comparison, ComparisonList, ComparisonMaps, ComparisonRequest
from app.schemas.jobs import Job
from app.services import comparisons
from app.services.jobs import accepted

router = APIRouter(prefix="/comparisons", tags=["comparisons"])


@router.post("", status_code=202)
def create_comparison(
    body: ComparisonRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Hold a model against experiments, the fitted ones or ones held out."""
    return accepted(comparisons.submit(container, body, key), response)


@router.get("")
def list_comparisons(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> ComparisonList:
    """Comparisons, newest first."""
    return comparisons.page(resources, plant_id, limit, cursor)


@router.get("/{comparisonId}")
def get_comparison(comparisonId: str, resources: ResourcesDependency) -> Comparison:
    """One comparison: lack of fit overall, per operating point, per band and per class of lines."""
    return comparisons.get(resources, comparisonId)


@router.get("/{comparisonId}/maps")
def get_comparison_maps(comparisonId: str, container: ContainerDependency) -> ComparisonMaps:
    """The normalised residuals over operating point and frequency."""
    return comparisons.maps(container, comparisonId)


@router.get("/{comparisonId}/responses/{experimentId}")
def get_compared_response(comparisonId: str, experimentId: str, container: ContainerDependency) -> ComparedResponse:
    """The frequency response of one experiment as measured, and as the model answers to the same input."""
    return comparisons.response(container, comparisonId, experimentId)


@router.get("/{comparisonId}/file", response_class=Response, responses=file_answer("npz", "mat"))
def get_comparison_file(
    comparisonId: str, container: ContainerDependency, format: Annotated[Literal["npz", "mat"], Query()] = "npz"
) -> Response:
    """The same as arrays, numbered by the place of the experiment; line classes are 0, 1 odd and 2 even."""
    content = comparisons.as_file(container, comparisonId, format)
    return file_response(content, f"comparison-{comparisonId}", format)
