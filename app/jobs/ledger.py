"""The ledger of jobs as services see it: submit, look, watch, cancel. Every change is one transaction."""

import logging
from collections.abc import Collection, Sequence
from datetime import UTC, datetime
from typing import Any, Protocol, get_args

from sqlalchemy import func, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from app.errors import ConflictError, NotFoundError
from app.jobs.hub import Hub
from app.jobs.records import FINAL_STATES, JobEventRecord, JobRecord, JobState
from app.jobs.transitions import event_of, move, record_of, tell
from app.store.database import Database
from app.store.identifiers import is_identifier, new_identifier
from app.store.resources import Page, checked_cursor, page
from app.store.rows import JobEventRow, JobRow

logger = logging.getLogger(__name__)


class Dispatcher(Protocol):
    """Who runs the jobs, as far as the ledger needs to know."""

    def wake(self) -> None:
        """There is a new job."""
        ...

    def cancel(self, job_id: str) -> None:
        """End the child process of a job that was cancelled, if there is one."""
        ...


class Ledger:
    """All jobs ever acknowledged. Thread-safe; what a method has returned survives a crash."""

    def __init__(self, database: Database, kinds: Collection[str], dispatcher: Dispatcher, hub: Hub) -> None:
        self._database = database
        self._kinds = kinds
        self._dispatcher = dispatcher
        self._hub = hub

    def submit(
        self,
        kind: str,
        payload: dict[str, Any],
        resource_kind: str,
        plant_id: str | None = None,
        idempotency_key: str | None = None,
        request_fingerprint: str | None = None,
    ) -> JobRecord:
        """Accept a job of `kind` that makes one resource of `resource_kind` (its collection, such as "models").

        `payload` is plain JSON and all that the task gets. With an `idempotency_key` that was used before, the job of
        that time is returned when `request_fingerprint` is the same (see `app.services.jobs.fingerprint`), and
        ConflictError is raised when it is not. Raises ValueError for an unknown kind of job.
        """
        if kind not in self._kinds:
            raise ValueError(f"unknown kind of job {kind!r}; there are {', '.join(sorted(self._kinds))}")
        row = JobRow(
            id=new_identifier(),
            kind=kind,
            state="queued",
            payload=payload,
            resource_kind=resource_kind,
            resource_id=new_identifier(),
            plant_id=plant_id,
            idempotency_key=idempotency_key,
            request_fingerprint=request_fingerprint,
            fraction=0.0,
            message="waiting",
            attempts=0,
            created_at=datetime.now(UTC),
        )
        record = self._insert_once(row)
        logger.info("job %s (%s) is %s", record.id, record.kind, record.state)
        self._dispatcher.wake()
        return record

    def _insert_once(self, row: JobRow) -> JobRecord:
        key, fingerprint = row.idempotency_key, row.request_fingerprint
        try:
            with self._database.write() as session:
                earlier = _with_key(session, key)
                if earlier is not None:
                    return _same_request(earlier, fingerprint)
                session.add(row)
                tell(session, row, "queued", row.created_at)
                return record_of(row)
        except IntegrityError:  # the same key was committed by another server in the meantime
            with self._database.read() as session:
                earlier = _with_key(session, key)
                if earlier is None:
                    raise
                return _same_request(earlier, fingerprint)

    def get(self, job_id: str) -> JobRecord:
        """The job; raises NotFoundError when there is none."""
        with self._database.read() as session:
            return record_of(_existing(session, job_id))

    def list(self, state: JobState | None = None, limit: int = 50, cursor: str | None = None) -> Page[JobRecord]:
        """A page of jobs, newest first; raises UnprocessableError for a bad cursor."""
        query = select(JobRow)
        if state is not None:
            query = query.where(JobRow.state == state)
        if checked_cursor(cursor) is not None:
            query = query.where(JobRow.id < cursor)
        with self._database.read() as session:
            rows = session.scalars(query.order_by(JobRow.id.desc()).limit(limit + 1)).all()
            return page([record_of(row) for row in rows], limit)

    def count(self) -> dict[str, float]:
        """How many jobs are in each state that one can be in."""
        query = select(JobRow.state, func.count()).group_by(JobRow.state)
        with self._database.read() as session:
            found = {str(state): float(count) for state, count in session.execute(query)}
        return dict.fromkeys(get_args(JobState.__value__), 0.0) | found

    def events(self, job_id: str, after: int = 0, limit: int = 500) -> Sequence[JobEventRecord]:
        """What happened to a job after the event `after`, oldest first."""
        query = select(JobEventRow).where(JobEventRow.job_id == job_id, JobEventRow.seq > after)
        with self._database.read() as session:
            return [event_of(row) for row in session.scalars(query.order_by(JobEventRow.seq).limit(limit))]

    def cancel(self, job_id: str) -> JobRecord:
        """End a queued or running job for good; raises ConflictError when it has finished, NotFoundError if unknown."""
        with self._database.write() as session:
            row = _existing(session, job_id, for_update=True)
            if row.state in FINAL_STATES:
                raise ConflictError(f"the job {job_id} has already {_finished_how(row.state)}")
            row.message = "cancelled"
            move(session, row, "cancelled")
            record = record_of(row)
        self._dispatcher.cancel(job_id)
        self._hub.notify(job_id)
        return record


def _existing(session: Session, job_id: str, for_update: bool = False) -> JobRow:
    row = session.get(JobRow, job_id, with_for_update=for_update) if is_identifier(job_id) else None
    if row is None:
        raise NotFoundError(f"there is no /v1/jobs/{job_id}")
    return row


def _with_key(session: Session, key: str | None) -> JobRow | None:
    if key is None:
        return None
    return session.scalars(select(JobRow).where(JobRow.idempotency_key == key)).one_or_none()


def _same_request(earlier: JobRow, fingerprint: str | None) -> JobRecord:
    if earlier.request_fingerprint != fingerprint:
        raise ConflictError(
            f"this Idempotency-Key was used for another request, the one of /v1/jobs/{earlier.id}; use a new key"
        )
    return record_of(earlier)


def _finished_how(state: str) -> str:
    return "been cancelled" if state == "cancelled" else state
