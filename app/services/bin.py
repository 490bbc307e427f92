"""Deleting, restoring and renaming resources of all collections."""

from typing import Any

from app.container import Container
from app.errors import UnprocessableError
from app.schemas.bin import Deletion, DeletionList, RenameRequest, ResourceLink, ResourceLinks
from app.store.resources import Resource


def dependents(container: Container, collection: str, identifier: str) -> ResourceLinks:
    """What would be deleted with a resource."""
    return _links(container.bin.dependents(collection, identifier))


def delete(container: Container, collection: str, identifier: str, with_dependents: bool) -> ResourceLinks:
    """Put a resource into the bin."""
    return _links(container.bin.delete(collection, identifier, with_dependents))


def restore(container: Container, identifier: str) -> ResourceLinks:
    """Take a resource, and what went with it, out of the bin."""
    return _links(container.bin.restore(identifier))


def deleted(container: Container, limit: int, cursor: str | None) -> DeletionList:
    """Part of what is in the bin."""
    found = container.bin.deleted(limit, cursor)
    items = [
        Deletion(id=one.id, deleted_at=moment, resource=link_to(one), others=others)
        for one, moment, others in found.items
    ]
    return DeletionList(items=items, next_cursor=found.next_cursor)


def rename(container: Container, collection: str, identifier: str, request: RenameRequest) -> ResourceLink:
    """Change name and description; raises UnprocessableError for resources that have none."""
    document = dict(container.resources.get(collection, identifier).document)
    for field, value in (("name", request.name), ("description", request.description)):
        if value is not None:
            document = _with(document, field, value, collection)
    return link_to(container.bin.change(collection, identifier, document))


def link_to(resource: Resource) -> ResourceLink:
    """A resource by its identifier and name."""
    holder = resource.document if "name" in resource.document else resource.document.get("request", {})
    name = holder.get("name") if isinstance(holder, dict) else None
    return ResourceLink(collection=resource.kind, id=resource.id, href=resource.href, name=name or "")


def _with(document: dict[str, Any], field: str, value: str, collection: str) -> dict[str, Any]:
    """A document with another name, which stands in it or in the request that it repeats."""
    if field in document:
        return {**document, field: value}
    request = document.get("request")
    if isinstance(request, dict) and field in request:
        return {**document, "request": {**request, field: value}}
    raise UnprocessableError.at(f"/{field}", f"{collection} have no {field}")


def _links(found: list[Resource]) -> ResourceLinks:
    return ResourceLinks(items=[link_to(one) for one in found])
