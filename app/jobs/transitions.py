"""What the ledger and the journal share: reading a row, changing its state, telling of the change."""

from datetime import UTC, datetime
from typing import Any, cast

from sqlalchemy.orm import Session

from app.jobs.records import FINAL_STATES, EventName, JobEventRecord, JobRecord, JobState
from app.store.postgres import announce
from app.store.resources import href
from app.store.rows import JobEventRow, JobRow

_EVENT_OF_STATE: dict[JobState, EventName] = {
    "running": "started",
    "succeeded": "succeeded",
    "failed": "failed",
    "cancelled": "cancelled",
}


def record_of(row: JobRow) -> JobRecord:
    """The job in a row, without its payload."""
    return JobRecord(
        id=row.id,
        kind=row.kind,
        state=cast(JobState, row.state),
        resource_kind=row.resource_kind,
        resource_id=row.resource_id,
        plant_id=row.plant_id,
        fraction=row.fraction,
        message=row.message,
        attempts=row.attempts,
        created_at=row.created_at,
        started_at=row.started_at,
        finished_at=row.finished_at,
        problem=row.problem,
    )


def event_of(row: JobEventRow) -> JobEventRecord:
    """The event in a row."""
    return JobEventRecord(row.seq, row.job_id, row.at, cast(EventName, row.name), row.data)


def move(session: Session, row: JobRow, state: JobState, event: EventName | None = None) -> None:
    """Change the state of a job and tell of it, in the transaction of `session`."""
    now = datetime.now(UTC)
    row.state = state
    if state == "running":
        row.started_at = now
    if state in FINAL_STATES:
        row.finished_at = now
    tell(session, row, event or _EVENT_OF_STATE[state], now)


def tell(session: Session, row: JobRow, event: EventName, at: datetime | None = None) -> None:
    """Add an event with what the job is now, in the transaction of `session`."""
    session.flush()
    session.add(JobEventRow(job_id=row.id, at=at or datetime.now(UTC), name=event, data=_snapshot(row)))
    session.flush()
    announce(session, row.id, event)


def _snapshot(row: JobRow) -> dict[str, Any]:
    return {
        "state": row.state,
        "attempts": row.attempts,
        "progress": {"fraction": row.fraction, "message": row.message},
        "result": result_of(row.state, row.resource_kind, row.resource_id),
        "problem": row.problem,
    }


def result_of(state: str, resource_kind: str, resource_id: str) -> dict[str, str] | None:
    """Where what the job made is found, once it has succeeded."""
    if state != "succeeded":
        return None
    return {"kind": resource_kind, "id": resource_id, "href": href(resource_kind, resource_id)}
