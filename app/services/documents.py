"""Rows to documents, and the resources that a request names."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from app.errors import UnprocessableError
from app.store.resources import Page, Resource, ResourceRepository

Document = TypeVar("Document")


def fields(resource: Resource, *more: str) -> dict[str, Any]:
    """The document of a row with its identifier and age, and with plantId or jobId where asked for."""
    known = {"plantId": resource.plant_id, "jobId": resource.job_id}
    added = {"id": resource.id, "createdAt": resource.created_at}
    return {**resource.document, **added, **{name: known[name] for name in more}}


def items(page: Page[Resource], convert: Callable[[Resource], Document]) -> list[Document]:
    """The documents of a page."""
    return [convert(resource) for resource in page.items]


def named(resources: ResourceRepository, kind: str, identifier: str, pointer: str) -> Resource:
    """The resource that a field of the body names; raises UnprocessableError at the field when there is none."""
    found = resources.find(kind, identifier)
    if found is None:
        raise UnprocessableError.at(pointer, f"there is no /v1/{kind}/{identifier}")
    return found


def of_plant(resource: Resource, plant_id: str, pointer: str) -> Resource:
    """The resource again; raises UnprocessableError at the field when it belongs to another plant."""
    if resource.plant_id != plant_id:
        raise UnprocessableError.at(pointer, f"{resource.href} belongs to another plant, {resource.plant_id}")
    return resource


def named_of_plant(
    resources: ResourceRepository, kind: str, identifiers: Sequence[str], plant_id: str, pointer: str
) -> list[Resource]:
    """The resources of a plant that a list in the body names, each of them once."""
    if len(set(identifiers)) < len(identifiers):
        raise UnprocessableError.at(pointer, "the same resource is named twice")
    return [
        of_plant(named(resources, kind, identifier, f"{pointer}/{i}"), plant_id, f"{pointer}/{i}")
        for i, identifier in enumerate(identifiers)
    ]
