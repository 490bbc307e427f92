"""Plants: describe, list, look."""

from fastapi import APIRouter, Response

from app.dependencies import Cursor, Limit, ResourcesDependency
from app.schemas.plants import Plant, PlantList, PlantRequest
from app.services import plants

router = APIRouter(prefix="/plants", tags=["plants"])


@router.post("", status_code=201)
def create_plant(body: PlantRequest, resources: ResourcesDependency, response: Response) -> Plant:
    """Describe a plant: its scheduling variables, signals and model structure."""
    plant = plants.create(resources, body)
    response.headers["Location"] = f"/v1/plants/{plant.id}"
    return plant


@router.get("")
def list_plants(resources: ResourcesDependency, limit: Limit = 50, cursor: Cursor = None) -> PlantList:
    """All plants, newest first."""
    return plants.page(resources, limit, cursor)


@router.get("/{plantId}")
def get_plant(plantId: str, resources: ResourcesDependency) -> Plant:
    """One plant."""
    return plants.get(resources, plantId)
