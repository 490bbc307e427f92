"""Runs jobs in child processes of this machine."""

import os
from collections.abc import Mapping

from app.jobs.journal import Journal
from app.jobs.progress import ProgressPump
from app.jobs.slot import Slot
from app.jobs.worker import ONE_THREAD
from app.settings import Settings
from app.store.room import Room


class LocalExecutor:
    """As many slots as `settings.workers`. Start after `Journal.recover`; children start with the first jobs."""

    def __init__(self, journal: Journal, kinds: Mapping[str, str], settings: Settings) -> None:
        room = Room(settings.data_dir, settings.disk_reserve_bytes)
        self._slots = [Slot(journal, kinds, settings, room) for _ in range(settings.workers)]
        self._stopped = False
        self._progress = ProgressPump(journal, [slot.child.reports for slot in self._slots])

    def start(self) -> None:
        """Begin to take jobs. Children inherit one thread each for linear algebra."""
        for name, value in ONE_THREAD.items():
            os.environ.setdefault(name, value)
        self._progress.start()
        for slot in self._slots:
            slot.start()

    def stop(self) -> None:
        """End all running jobs, which are queued again, and all child processes; does nothing the second time."""
        if self._stopped:
            return
        self._stopped = True
        for slot in self._slots:
            slot.stop()
        for slot in self._slots:
            slot.join()
        self._progress.stop()
        for slot in self._slots:
            slot.child.close_pipe()

    def wake(self) -> None:
        """There is a new job."""
        for slot in self._slots:
            slot.wake()

    def end_lost(self, job_id: str | None = None) -> None:
        """End child processes whose run is no longer the present one of its job: of this job, or of any."""
        for slot in self._slots:
            slot.end_if_lost(job_id)

    def cancel(self, job_id: str) -> None:
        """End the child process that runs this job, if there is one."""
        for slot in self._slots:
            slot.child.end(job_id)
