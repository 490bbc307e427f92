"""The record of who asked to make, change or end what."""

import logging
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import select

from app.store.database import Database
from app.store.identifiers import new_identifier
from app.store.resources import Page, checked_cursor, page
from app.store.rows import AuditRow

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class AuditRecord:
    """One request and its answer."""

    id: str
    at: datetime
    who: str
    method: str
    path: str
    status: int
    request_id: str


class Audit:
    """Lines are only ever added. Thread-safe."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def add(self, who: str, method: str, path: str, status: int, request_id: str) -> None:
        """Keep a line; where the database is full or away the log has it."""
        row = AuditRow(
            id=new_identifier(),
            at=datetime.now(UTC),
            who=who,
            method=method,
            path=path,
            status=status,
            request_id=request_id,
        )
        try:
            with self._database.write() as session:
                session.add(row)
        except Exception as error:
            logger.error("%s: %s %r %s is not in the audit: %s", who, method, path, status, error)

    def list(self, limit: int, cursor: str | None) -> Page[AuditRecord]:
        """A page of lines, newest first."""
        query = select(AuditRow)
        if checked_cursor(cursor) is not None:
            query = query.where(AuditRow.id < cursor)
        with self._database.read() as session:
            rows = session.scalars(query.order_by(AuditRow.id.desc()).limit(limit + 1)).all()
        return page([_record(row) for row in rows], limit)


def _record(row: AuditRow) -> AuditRecord:
    return AuditRecord(row.id, row.at, row.who, row.method, row.path, row.status, row.request_id)
