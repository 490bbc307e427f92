"""The repository of everything that was made. Resources are added; only `app.store.bin` changes names and deletes."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Generic, TypeVar

from sqlalchemy import select
from sqlalchemy.orm import Session

from app.errors import NotFoundError, UnprocessableError
from app.store.database import Database
from app.store.identifiers import is_identifier, new_identifier
from app.store.rows import ResourceRow

Item = TypeVar("Item")


@dataclass(frozen=True)
class Resource:
    """One thing that was made. `kind` is its collection in the URL, such as "plants"."""

    id: str
    kind: str
    plant_id: str | None
    job_id: str | None
    created_at: datetime
    document: dict[str, Any]
    arrays: str | None

    @property
    def href(self) -> str:
        return href(self.kind, self.id)


@dataclass(frozen=True)
class Page(Generic[Item]):
    """Part of a list, newest first; `next_cursor` continues it and is None at its end."""

    items: Sequence[Item]
    next_cursor: str | None


def href(kind: str, identifier: str) -> str:
    """Where a resource is found."""
    return f"/v1/{kind}/{identifier}"


def add_resource(session: Session, resource: Resource) -> None:
    """Add a row in the transaction of `session`."""
    session.add(ResourceRow(**vars(resource)))
    session.flush()


def checked_cursor(cursor: str | None) -> str | None:
    """`cursor` if it can be one; raises UnprocessableError otherwise."""
    if cursor is not None and not is_identifier(cursor):
        raise UnprocessableError.at("/cursor", "is not a nextCursor of an earlier answer", "query")
    return cursor


class ResourceRepository:
    """Get, list and add resources; each call is one transaction."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(
        self,
        kind: str,
        document: dict[str, Any],
        plant_id: str | None = None,
        arrays: str | None = None,
        identifier: str | None = None,
    ) -> Resource:
        """Keep a resource that needs no job; durable on return."""
        identifier = identifier or new_identifier()
        resource = Resource(identifier, kind, plant_id, None, datetime.now(UTC), document, arrays)
        with self._database.write() as session:
            add_resource(session, resource)
        return resource

    def get(self, kind: str, identifier: str) -> Resource:
        """The resource; raises NotFoundError when there is none of this kind."""
        found = self.find(kind, identifier)
        if found is None:
            raise NotFoundError(f"there is no {href(kind, identifier)}")
        return found

    def find(self, kind: str, identifier: str) -> Resource | None:
        """The resource, or None when there is none of this kind."""
        if not is_identifier(identifier):
            return None
        query = select(ResourceRow).where(
            ResourceRow.id == identifier, ResourceRow.kind == kind, ResourceRow.deleted_at.is_(None)
        )
        with self._database.read() as session:
            row = session.scalars(query).one_or_none()
        return None if row is None else resource_of(row)

    def list(
        self, kind: str, plant_id: str | None = None, limit: int = 50, cursor: str | None = None
    ) -> Page[Resource]:
        """A page of resources of one kind, newest first; raises UnprocessableError for a bad cursor."""
        query = select(ResourceRow).where(ResourceRow.kind == kind, ResourceRow.deleted_at.is_(None))
        if plant_id is not None:
            query = query.where(ResourceRow.plant_id == plant_id)
        if checked_cursor(cursor) is not None:
            query = query.where(ResourceRow.id < cursor)
        with self._database.read() as session:
            rows = session.scalars(query.order_by(ResourceRow.id.desc()).limit(limit + 1)).all()
        return page([resource_of(row) for row in rows], limit)


def page(found: Sequence[Item], limit: int) -> Page[Item]:
    """The first `limit` of up to `limit + 1` items found, which have an `id`."""
    items = found[:limit]
    more = len(found) > limit
    return Page(items, getattr(items[-1], "id") if more else None)  # noqa: B009


def resource_of(row: ResourceRow) -> Resource:
    """What a row holds."""
    return Resource(row.id, row.kind, row.plant_id, row.job_id, row.created_at, row.document, row.arrays)
