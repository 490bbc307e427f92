"""Designs: ask for experiments, look at them, have them made into signals."""

from typing import Annotated

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.schemas.designs import Design, DesignList, DesignRequest
from app.schemas.jobs import Job
from app.schemas.signals import SignalsRequest
from app.services import designs, signals
from app.services.jobs import accepted

router = APIRouter(prefix="/designs", tags=["designs"])


@router.post("", status_code=202)
def create_design(
    body: DesignRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Design the experiments of least input energy that guarantee the accuracy asked for."""
    return accepted(designs.submit(container, body, key), response)


@router.get("")
def list_designs(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> DesignList:
    """Designs, newest first."""
    return designs.page(resources, plant_id, limit, cursor)


@router.get("/{designId}")
def get_design(designId: str, resources: ResourcesDependency) -> Design:
    """One design: operating points, spectra, energies and the certificate."""
    return designs.get(resources, designId)


@router.post("/{designId}/signals", status_code=202)
def create_signals(
    designId: str,
    body: SignalsRequest,
    container: ContainerDependency,
    response: Response,
    key: IdempotencyKey = None,
) -> Job:
    """Make a design into signals to play, one an operating point."""
    return accepted(signals.submit(container, designId, body, key), response)
