"""The events of one job as a stream that ends with the job."""

import asyncio
import contextlib
from collections.abc import AsyncIterator

from anyio.to_thread import run_sync
from sse_starlette import ServerSentEvent

from app.jobs.hub import Hub
from app.jobs.ledger import Ledger
from app.jobs.records import FINAL_STATES, JobEventRecord
from app.schemas.jobs import JobEvent

SECONDS_BETWEEN_LOOKS = 2.0


async def watch(ledger: Ledger, hub: Hub, job_id: str, after: int = 0) -> AsyncIterator[ServerSentEvent]:
    """Events after `after`, those of the past at once and new ones as they come, up to the final state."""
    with hub.watching() as changed:
        while True:
            changed.clear()
            record = await run_sync(ledger.get, job_id)
            events = await run_sync(ledger.events, job_id, after)
            for event in events:
                after = event.seq
                yield _sent(event)
            if not events and record.state in FINAL_STATES:
                return
            if not events:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(changed.wait(), SECONDS_BETWEEN_LOOKS)


def _sent(event: JobEventRecord) -> ServerSentEvent:
    return ServerSentEvent(JobEvent.of(event).model_dump_json(by_alias=True), event=event.name, id=str(event.seq))
