"""The bin: delete, restore and rename whatever was made."""

from typing import Annotated

from fastapi import APIRouter, Query

from app.dependencies import ContainerDependency, Cursor, Limit
from app.schemas.bin import Collection, DeletionList, RenameRequest, ResourceLink, ResourceLinks
from app.services import bin as bins

router = APIRouter(tags=["deletions"])


@router.get("/bin")
def list_deleted(container: ContainerDependency, limit: Limit = 50, cursor: Cursor = None) -> DeletionList:
    """What was deleted, with the moment; it stays until it is restored."""
    return bins.deleted(container, limit, cursor)


@router.post("/bin/{deletionId}/restoration")
def restore_deleted(deletionId: str, container: ContainerDependency) -> ResourceLinks:
    """Bring back what was deleted, with all that was deleted with it; deletionId is that of the deleted resource."""
    return bins.restore(container, deletionId)


@router.get("/{collection}/{resourceId}/dependents")
def list_dependents(collection: Collection, resourceId: str, container: ContainerDependency) -> ResourceLinks:
    """What stands on a resource, directly or through others, and would be deleted with it."""
    return bins.dependents(container, collection, resourceId)


@router.delete("/{collection}/{resourceId}")
def delete_resource(
    collection: Collection,
    resourceId: str,
    container: ContainerDependency,
    with_dependents: Annotated[
        bool, Query(alias="withDependents", description="delete what depends on it as well; else that is a conflict")
    ] = False,
) -> ResourceLinks:
    """Put a resource into the bin; the answer names all that was deleted, the resource first."""
    return bins.delete(container, collection, resourceId, with_dependents)


@router.patch("/{collection}/{resourceId}")
def rename_resource(
    collection: Collection, resourceId: str, body: RenameRequest, container: ContainerDependency
) -> ResourceLink:
    """Give a resource another name or description; nothing else of it can be changed."""
    return bins.rename(container, collection, resourceId, body)
