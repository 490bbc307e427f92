"""The events of jobs as streams that end with their job; all streams of a job share what is read and written once."""

import asyncio
import contextlib
import logging
from bisect import bisect_right
from collections.abc import AsyncIterator, Sequence
from dataclasses import dataclass, field

from anyio.to_thread import run_sync

from app.errors import UnavailableError
from app.jobs.hub import Hub
from app.jobs.ledger import Ledger
from app.jobs.records import FINAL_STATES, JobEventRecord
from app.schemas.jobs import JobEvent

logger = logging.getLogger(__name__)
SECONDS_BETWEEN_LOOKS = 2.0
SECONDS_BETWEEN_PINGS = 15.0
WOKEN_AT_ONCE = 25
PING = b": ping\r\n\r\n"


@dataclass(eq=False)
class _Feed:
    """What has happened to one job so far, as it is sent, and who waits for more."""

    sequences: list[int] = field(default_factory=list)
    chunks: list[bytes] = field(default_factory=list)
    waiting: set[asyncio.Event] = field(default_factory=set)
    streams: int = 0
    ended: bool = False
    reader: "asyncio.Task[None] | None" = None

    def add(self, events: Sequence[JobEventRecord]) -> None:
        for event in events:
            self.sequences.append(event.seq)
            self.chunks.append(_sent(event))
            self.ended = self.ended or event.data["state"] in FINAL_STATES

    async def wake(self) -> None:
        """Let those who wait go on, a few at a time, so that other requests come in between."""
        for count, one in enumerate(list(self.waiting), start=1):
            one.set()
            if count % WOKEN_AT_ONCE == 0:
                await asyncio.sleep(0)


class JobEvents:
    """Streams of the events of jobs; at most `most_streams` at a time. Belongs to one event loop."""

    def __init__(self, ledger: Ledger, hub: Hub, most_streams: int) -> None:
        self._ledger = ledger
        self._hub = hub
        self._most = most_streams
        self._feeds: dict[str, _Feed] = {}

    @property
    def streams(self) -> int:
        """How many streams there are now."""
        return sum(feed.streams for feed in self._feeds.values())

    def watch(self, job_id: str, after: int = 0) -> AsyncIterator[bytes]:
        """Events after `after`, those of the past at once and new ones as they come, up to the final state.

        Raises UnavailableError when there are as many streams as there may be.
        """
        if self.streams >= self._most:
            raise UnavailableError(
                f"{self._most} event streams are open, which is the most; look at GET /v1/jobs/{job_id} now and then,"
                " or raise LPV_OED_MAX_EVENT_STREAMS",
                headers={"Retry-After": "5"},
            )
        return self._stream(job_id, after)

    async def _stream(self, job_id: str, after: int) -> AsyncIterator[bytes]:
        feed = self._feeds.setdefault(job_id, _Feed())
        news = asyncio.Event()
        feed.streams += 1
        feed.waiting.add(news)
        if feed.reader is None:
            feed.reader = asyncio.create_task(self._read(job_id, feed))
        try:
            async for chunk in self._chunks(feed, news, after):
                yield chunk
        finally:
            feed.waiting.discard(news)
            feed.streams -= 1
            if not feed.streams:
                self._feeds.pop(job_id, None)
                feed.reader.cancel()

    async def _chunks(self, feed: _Feed, news: asyncio.Event, after: int) -> AsyncIterator[bytes]:
        while not self._hub.closed:
            news.clear()
            place = bisect_right(feed.sequences, after)
            if place < len(feed.chunks):
                after, chunks = feed.sequences[-1], feed.chunks[place:]
                yield b"".join(chunks)
            elif feed.ended:
                return
            else:
                try:
                    await asyncio.wait_for(news.wait(), SECONDS_BETWEEN_PINGS)
                except TimeoutError:
                    yield PING

    async def _read(self, job_id: str, feed: _Feed) -> None:
        with self._hub.watching(job_id) as changed:
            while not feed.ended and not self._hub.closed:
                changed.clear()
                if await self._look(job_id, feed):
                    await feed.wake()
                else:
                    with contextlib.suppress(TimeoutError):
                        await asyncio.wait_for(changed.wait(), SECONDS_BETWEEN_LOOKS)
        await feed.wake()

    async def _look(self, job_id: str, feed: _Feed) -> bool:
        """Whether there was something new; nothing while the database cannot be read."""
        try:
            events = await run_sync(self._ledger.events, job_id, feed.sequences[-1] if feed.sequences else 0)
        except Exception as error:
            logger.warning("the events of job %s could not be read; trying again: %s", job_id, error)
            return False
        feed.add(events)
        return bool(events)


def _sent(event: JobEventRecord) -> bytes:
    data = JobEvent.of(event).model_dump_json(by_alias=True, exclude_none=True)
    return f"id: {event.seq}\r\nevent: {event.name}\r\ndata: {data}\r\n\r\n".encode()
