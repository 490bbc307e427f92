"""Staircases: effects added until noise explains what is left."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.schemas.jobs import Job
from app.schemas.staircases import Staircase, StaircaseList, StaircaseRequest
from app.services import staircases
from app.services.jobs import accepted

router = APIRouter(tags=["staircases"])


@router.post("/models/{modelId}/staircases", status_code=202)
def create_staircase(
    modelId: str,
    body: StaircaseRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Diagnose a model, add the best effect, and again, until noise explains what is left; every version is kept."""
    return accepted(staircases.submit(container, modelId, body, key), response)


@router.get("/staircases")
def list_staircases(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> StaircaseList:
    """Staircases, newest first."""
    return staircases.page(resources, plant_id, limit, cursor)


@router.get("/staircases/{staircaseId}")
def get_staircase(staircaseId: str, resources: ResourcesDependency) -> Staircase:
    """One staircase: its versions with their errors."""
    return staircases.get(resources, staircaseId)
