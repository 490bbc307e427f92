"""Jobs: list, look, watch, cancel."""

from typing import Annotated, Any

from anyio.to_thread import run_sync
from fastapi import APIRouter, Header, Query
from fastapi.responses import StreamingResponse

from app.dependencies import ContainerDependency, Cursor, LedgerDependency, Limit
from app.jobs.records import JobState
from app.schemas.jobs import Job, JobPage

router = APIRouter(prefix="/jobs", tags=["jobs"])

EventId = Annotated[str | None, Header(alias="Last-Event-ID", pattern=r"^[0-9]{1,18}$")]
EventIdQuery = Annotated[str | None, Query(alias="lastEventId", pattern=r"^[0-9]{1,18}$")]
NOT_KEPT = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
EVENT_STREAM: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Server-sent events; the data of each is a JobEvent, its id the sequence",
        "content": {"text/event-stream": {"schema": {"type": "string"}}},
    },
    503: {"description": "As many streams are open as there may be"},
}


class EventStream(StreamingResponse):
    """Server-sent events."""

    media_type = "text/event-stream"


@router.get("")
def list_jobs(
    ledger: LedgerDependency, state: JobState | None = None, limit: Limit = 50, cursor: Cursor = None
) -> JobPage:
    """All jobs, newest first."""
    page = ledger.list(state, limit, cursor)
    return JobPage(items=[Job.of(record) for record in page.items], next_cursor=page.next_cursor)


@router.get("/{jobId}")
def get_job(jobId: str, ledger: LedgerDependency) -> Job:
    """One job."""
    return Job.of(ledger.get(jobId))


@router.post("/{jobId}/cancellation", responses={409: {"description": "The job has already finished"}})
def cancel_job(jobId: str, ledger: LedgerDependency) -> Job:
    """End a queued or running job for good."""
    return Job.of(ledger.cancel(jobId))


@router.get("/{jobId}/events", response_class=EventStream, responses=EVENT_STREAM)
async def watch_job_events(
    jobId: str,
    container: ContainerDependency,
    last_event_id: EventId = None,
    last_event_id_query: EventIdQuery = None,
) -> StreamingResponse:
    """What happens to a job, from its submission or from after the event Last-Event-ID, until it has finished."""
    await run_sync(container.ledger.get, jobId)
    after = int(last_event_id or last_event_id_query or 0)
    return EventStream(container.job_events.watch(jobId, after), headers=NOT_KEPT)
