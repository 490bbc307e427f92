"""One thread that writes down what the running jobs report."""

import json
import logging
from collections.abc import Sequence
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from threading import Event, Thread
from typing import Any

from app.jobs.journal import Journal, Progress, Run

logger = logging.getLogger(__name__)


class ProgressPump:
    """Reads the pipes of all children; of several reports of one run only the last is written down."""

    def __init__(self, journal: Journal, pipes: "Sequence[Connection[Any, Any]]") -> None:
        self._journal = journal
        self._pipes = pipes
        self._stopping = Event()
        self._bell, self._bell_pull = Pipe(duplex=False)
        self._thread = Thread(target=self._loop, name="lpv-oed-job-progress", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stopping.set()
        self._bell_pull.close()
        self._thread.join()
        self._bell.close()

    def _loop(self) -> None:
        while not self._stopping.is_set():
            ready = wait([*self._pipes, self._bell])
            try:
                self._write_down([pipe for pipe in self._pipes if pipe in ready])
            except Exception:
                logger.exception("progress could not be written down")

    def _write_down(self, ready: "Sequence[Connection[Any, Any]]") -> None:
        latest: dict[Run, Progress] = {}
        for pipe in ready:
            while pipe.poll():
                job_id, attempt, fraction, message = json.loads(pipe.recv_bytes())
                latest[job_id, attempt] = (fraction, message)
        if latest:
            self._journal.progress(latest)
