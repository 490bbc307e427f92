"""Plants: checked and kept."""

from typing import Any

from app import __version__
from app.conversion.channels import check_unit
from app.conversion.misuse import pointing
from app.conversion.plants import MATRIX_NAMES, is_state_space, plant_dependence, rational_of
from app.errors import UnprocessableError
from app.schemas.plants import Plant, PlantList, PlantRequest
from app.services.documents import fields, items
from app.store.resources import Resource, ResourceRepository

KIND = "plants"
POINTERS = {
    "n_k": "/structure",
    "sample_time": "/structure",
    "structure": "/structure",
    "maximum": "/schedulingVariables",
    "scheduling_variables": "/schedulingVariables",
    "coefficient_bases": "/coefficientBases",
}


def described(request: PlantRequest) -> dict[str, Any]:
    """The document of a plant; raises UnprocessableError when its parts do not fit each other."""
    _check_signals(request)
    with pointing(POINTERS, default="/basis"):
        state_space = is_state_space(request.structure)
        names = MATRIX_NAMES if state_space else rational_of(request.structure).coefficient_names
        dependence = plant_dependence(request)
    return {
        **request.as_json(),
        "softwareVersion": __version__,
        "parameterNames": list(dependence.parameter_names(names)),
        "neededOperatingPoints": dependence.needed_operating_points,
    }


def _check_signals(request: PlantRequest) -> None:
    """One input and output for rational structures, lists of them for state-space ones, with names that differ."""
    state_space = is_state_space(request.structure)
    for wanted, refused in (("inputs", "input"), ("outputs", "output")):
        if not state_space:
            wanted, refused = refused, wanted
        if getattr(request, wanted) is None:
            raise UnprocessableError.at(f"/{wanted}", f"{wanted} must be given for this structure")
        if getattr(request, refused) is not None:
            raise UnprocessableError.at(f"/{refused}", f"give {wanted} in place of {refused} for this structure")
    for name, signals in (("inputs", request.inputs), ("outputs", request.outputs)):
        if signals and len({signal.name for signal in signals}) < len(signals):
            raise UnprocessableError.at(f"/{name}", f"two {name} have the same name")
        for i, signal in enumerate(signals or ()):
            with pointing({"quantity": f"/{name}/{i}/quantity"}):
                check_unit(signal)
    for name, one in (("input", request.input), ("output", request.output)):
        if one is not None:
            with pointing({"quantity": f"/{name}/quantity"}):
                check_unit(one)


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
