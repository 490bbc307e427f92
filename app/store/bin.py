"""What was deleted: kept with the moment, found with what depends on it, and brought back."""

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Select, Text, cast, or_, select, update
from sqlalchemy.orm import Session

from app.errors import ConflictError, NotFoundError
from app.store.database import Database
from app.store.identifiers import is_identifier
from app.store.resources import Page, Resource, checked_cursor, href, page, resource_of
from app.store.rows import ResourceRow

MOST_AT_ONCE = 100_000


class Bin:
    """Deletes, restores and changes names; each call is one transaction. A deleted resource is found nowhere else."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def dependents(self, kind: str, identifier: str) -> list[Resource]:
        """All that stands on a resource, directly or through others, newest first; raises NotFoundError."""
        with self._database.read() as session:
            return [resource_of(row) for row in _dependents(session, _present(session, kind, identifier))]

    def delete(self, kind: str, identifier: str, with_dependents: bool) -> list[Resource]:
        """Delete a resource, and with it what depends on it; what was deleted, the resource first.

        Raises NotFoundError, and ConflictError when something depends on it and is not to be deleted as well.
        """
        with self._database.write() as session:
            row = _present(session, kind, identifier)
            others = _dependents(session, row)
            if others and not with_dependents:
                known = ", ".join(href(other.kind, other.id) for other in others[:5])
                more = f" and {len(others) - 5} more" if len(others) > 5 else ""
                raise ConflictError(f"{known}{more} depend on it; delete them first, or all with withDependents=true")
            now = datetime.now(UTC)
            for one in (row, *others):
                one.deleted_at, one.deleted_with = now, row.id
            session.flush()
            return [resource_of(one) for one in (row, *others)]

    def restore(self, identifier: str) -> list[Resource]:
        """Bring back what was deleted under the identifier of its first; raises NotFoundError, ConflictError."""
        with self._database.write() as session:
            rows = session.scalars(_deleted().where(ResourceRow.deleted_with == identifier)).all()
            if not is_identifier(identifier) or not rows:
                raise NotFoundError(f"nothing was deleted under {identifier[:40]!r}; GET /v1/bin lists what was")
            _require_ground(session, rows)
            session.execute(
                update(ResourceRow)
                .where(ResourceRow.deleted_with == identifier)
                .values(deleted_at=None, deleted_with=None)
            )
            return [resource_of(row) for row in rows]

    def deleted(self, limit: int, cursor: str | None) -> Page[tuple[Resource, datetime, int]]:
        """What was deleted, one entry a deletion with its moment and how much went with it, newest resource first."""
        first = _deleted().where(ResourceRow.deleted_with == ResourceRow.id)
        if checked_cursor(cursor) is not None:
            first = first.where(ResourceRow.id < cursor)
        with self._database.read() as session:
            rows = session.scalars(first.order_by(ResourceRow.id.desc()).limit(limit + 1)).all()
            kept = page(rows, limit)
            found = []
            for row in kept.items:
                assert row.deleted_at is not None, "it is in the bin"
                others = session.scalars(_deleted().where(ResourceRow.deleted_with == row.id)).all()
                found.append((resource_of(row), row.deleted_at, len(others) - 1))
        return Page(found, kept.next_cursor)

    def change(self, kind: str, identifier: str, document: dict[str, Any]) -> Resource:
        """Put another document in the place of a resource's; raises NotFoundError."""
        with self._database.write() as session:
            row = _present(session, kind, identifier)
            row.document = document
            session.flush()
            return resource_of(row)


def _deleted() -> Select[ResourceRow]:
    return select(ResourceRow).where(ResourceRow.deleted_at.is_not(None))


def _present(session: Session, kind: str, identifier: str) -> ResourceRow:
    query = select(ResourceRow).where(
        ResourceRow.id == identifier, ResourceRow.kind == kind, ResourceRow.deleted_at.is_(None)
    )
    row = session.scalars(query).one_or_none() if is_identifier(identifier) else None
    if row is None:
        raise NotFoundError(f"there is no {href(kind, identifier)}")
    return row


def _dependents(session: Session, row: ResourceRow) -> list[ResourceRow]:
    """Rows whose documents name a row, or a row that does; of a plant everything that belongs to it."""
    found: dict[str, ResourceRow] = {}
    front = [row]
    while front and len(found) < MOST_AT_ONCE:
        names = [cast(ResourceRow.document, Text).contains(one.id) for one in front[:50]]
        of_plants = [one.id for one in front[:50] if one.kind == "plants"]
        naming = or_(*names, ResourceRow.plant_id.in_(of_plants))
        rows = session.scalars(select(ResourceRow).where(naming, ResourceRow.deleted_at.is_(None))).all()
        new = [one for one in rows if one.id != row.id and one.id not in found]
        found |= {one.id: one for one in new}
        front = [*front[50:], *new]
    return sorted(found.values(), key=lambda one: one.id, reverse=True)


def _require_ground(session: Session, rows: Sequence[ResourceRow]) -> None:
    """Raises ConflictError while something that restored rows name, or their plant, is in the bin."""
    returning = {row.id for row in rows}
    missing = [one for one in session.scalars(_deleted()).all() if one.id not in returning and _is_named(one, rows)]
    if missing:
        first = missing[0]
        raise ConflictError(
            f"it stands on {href(first.kind, first.id)}, deleted too; restore {first.deleted_with} first"
        )


def _is_named(one: ResourceRow, rows: Iterable[ResourceRow]) -> bool:
    return any(row.plant_id == one.id or one.id in str(row.document) for row in rows)
