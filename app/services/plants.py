"""Plants: checked and kept."""

from typing import Any

from app import __version__
from app.conversion.misuse import pointing
from app.conversion.plants import structure_and_dependence
from app.schemas.plants import Plant, PlantList, PlantRequest
from app.services.documents import fields, items
from app.store.resources import Resource, ResourceRepository

KIND = "plants"
POINTERS = {
    "n_k": "/structure",
    "sample_time": "/structure",
    "maximum": "/schedulingVariables",
    "scheduling_variables": "/schedulingVariables",
    "coefficient_bases": "/coefficientBases",
}


def described(request: PlantRequest) -> dict[str, Any]:
    """The document of a plant; raises UnprocessableError when its parts do not fit each other."""
    with pointing(POINTERS, default="/basis"):
        structure, dependence = structure_and_dependence(request)
    return {
        **request.as_json(),
        "softwareVersion": __version__,
        "parameterNames": list(dependence.parameter_names(structure.coefficient_names)),
        "neededOperatingPoints": dependence.needed_operating_points,
    }


def plant_of(resource: Resource) -> Plant:
    """The plant in a row."""
    return Plant.model_validate(fields(resource))


def create(resources: ResourceRepository, request: PlantRequest) -> Plant:
    """Keep a plant."""
    return plant_of(resources.add(KIND, described(request)))


def get(resources: ResourceRepository, plant_id: str) -> Plant:
    """The plant of an identifier."""
    return plant_of(resources.get(KIND, plant_id))


def page(resources: ResourceRepository, limit: int, cursor: str | None) -> PlantList:
    """Part of the list of plants."""
    found = resources.list(KIND, limit=limit, cursor=cursor)
    return PlantList(items=items(found, plant_of), next_cursor=found.next_cursor)
