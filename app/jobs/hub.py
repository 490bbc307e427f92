"""Wakes those who wait for something new in the ledger."""

import asyncio
import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock


class Hub:
    """Threads call `notify` after a commit; watchers in event loops wake up and look again."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._watchers: dict[asyncio.Event, asyncio.AbstractEventLoop] = {}

    def notify(self) -> None:
        """Wake every watcher; from any thread."""
        with self._lock:
            watchers = list(self._watchers.items())
        for event, loop in watchers:
            with contextlib.suppress(RuntimeError):  # the loop has just been closed
                loop.call_soon_threadsafe(event.set)

    @contextmanager
    def watching(self) -> Iterator[asyncio.Event]:
        """An event of the running loop that every `notify` sets."""
        event = asyncio.Event()
        with self._lock:
            self._watchers[event] = asyncio.get_running_loop()
        try:
            yield event
        finally:
            with self._lock:
                del self._watchers[event]
