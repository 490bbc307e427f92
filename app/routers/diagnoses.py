"""Diagnoses: what a model lacks."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.schemas.diagnoses import Diagnosis, DiagnosisList, DiagnosisRequest
from app.schemas.jobs import Job
from app.services import diagnoses
from app.services.jobs import accepted

router = APIRouter(prefix="/diagnoses", tags=["diagnoses"])


@router.post("", status_code=202)
def create_diagnosis(
    body: DiagnosisRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Look for the physical effect that explains where a model fails."""
    return accepted(diagnoses.submit(container, body, key), response)


@router.get("")
def list_diagnoses(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> DiagnosisList:
    """Diagnoses, newest first."""
    return diagnoses.page(resources, plant_id, limit, cursor)


@router.get("/{diagnosisId}")
def get_diagnosis(diagnosisId: str, resources: ResourcesDependency) -> Diagnosis:
    """One diagnosis: effects ranked with evidence, what cannot be told apart, what could not be judged."""
    return diagnoses.get(resources, diagnosisId)
