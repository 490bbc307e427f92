"""Simulations: look at them, take them out."""

from typing import Annotated, get_args

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, Limit, ResourcesDependency
from app.files.stored import Format
from app.routers.downloads import file_answer, file_response
from app.schemas.simulations import Simulation, SimulationData, SimulationList
from app.services import simulations

router = APIRouter(prefix="/simulations", tags=["simulations"])


@router.get("")
def list_simulations(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> SimulationList:
    """Simulations of models, newest first."""
    return simulations.page(resources, plant_id, limit, cursor)


@router.get("/{simulationId}")
def get_simulation(simulationId: str, resources: ResourcesDependency) -> Simulation:
    """One simulation in short."""
    return simulations.get(resources, simulationId)


@router.get("/{simulationId}/data")
def get_simulation_data(simulationId: str, container: ContainerDependency) -> SimulationData:
    """The samples: input, scheduling, output and its 95 % band."""
    return simulations.data(container, simulationId)


@router.get("/{simulationId}/file", response_class=Response, responses=file_answer(*get_args(Format)))
def get_simulation_file(
    simulationId: str, container: ContainerDependency, format: Annotated[Format, Query()] = "npz"
) -> Response:
    """The same as a file, which can be brought in as an experiment."""
    content = simulations.as_file(container, simulationId, format)
    return file_response(content, f"simulation-{simulationId}", format)
