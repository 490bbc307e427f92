"""Wakes those who wait for something new about a job."""

import asyncio
import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock


class Hub:
    """Threads call `notify` after a commit; who watches one of these jobs in an event loop wakes up and looks again."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._watchers: dict[str, dict[asyncio.Event, asyncio.AbstractEventLoop]] = {}
        self.closed = False

    def notify(self, *job_ids: str) -> None:
        """Wake the watchers of these jobs; from any thread."""
        with self._lock:
            watchers = [one for job_id in job_ids for one in self._watchers.get(job_id, {}).items()]
        _wake(watchers)

    def close(self) -> None:
        """Wake every watcher for the last time; from any thread."""
        self.closed = True
        with self._lock:
            watchers = [one for of_job in self._watchers.values() for one in of_job.items()]
        _wake(watchers)

    @contextmanager
    def watching(self, job_id: str) -> Iterator[asyncio.Event]:
        """An event of the running loop that every `notify` of this job sets."""
        event = asyncio.Event()
        with self._lock:
            self._watchers.setdefault(job_id, {})[event] = asyncio.get_running_loop()
        try:
            yield event
        finally:
            with self._lock:
                del self._watchers[job_id][event]
                if not self._watchers[job_id]:
                    del self._watchers[job_id]


def _wake(watchers: "list[tuple[asyncio.Event, asyncio.AbstractEventLoop]]") -> None:
    for event, loop in watchers:
        with contextlib.suppress(RuntimeError):  # the loop has just been closed
            loop.call_soon_threadsafe(event.set)
