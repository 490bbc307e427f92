"""One child process at a time, replaced when it ends, and the pipe by which it reports progress."""

import logging
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from threading import Lock

from pebble import ProcessExpired, ProcessFuture, ProcessPool

from app.jobs.outcomes import Crashed, Ended, Faulted, Outcome, TaskOutcome, TimedOut
from app.jobs.records import ClaimedJob
from app.jobs.worker import ChildOptions, initialize, run_task
from app.settings import Settings
from app.store.identifiers import new_identifier

logger = logging.getLogger(__name__)
SECONDS_OF_GRACE = 60.0


@dataclass(frozen=True)
class _Present:
    job_id: str
    future: "ProcessFuture[TaskOutcome]"


class Child:
    """Runs jobs one after the other in a limited child process.

    A pool of a single process, so that what happens to one job cannot reach the pipes and locks of another.
    `run` and `close` belong to one thread; `end` may be called from any.
    """

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._context = multiprocessing.get_context("spawn")
        self.reports, self._reports_writer = self._context.Pipe(duplex=False)
        self._lock = Lock()
        self._present: _Present | None = None
        self._pool: ProcessPool | None = None

    def run(self, job: ClaimedJob, module: str, wanted: Callable[[], bool]) -> Outcome:
        """Run a job to its end; `wanted` is asked once the job can be ended, in case it was cancelled before."""
        try:
            return self._run_once(job, module, wanted)
        except BrokenProcessPool:  # an idle process had ended, which says nothing about this job
            self._discard_pool()
        try:
            return self._run_once(job, module, wanted)
        except BrokenProcessPool:
            self._discard_pool()
            return Crashed(None)

    def end(self, job_id: str | None = None) -> None:
        """End the process if it runs this job, or whatever it runs."""
        with self._lock:
            if self._present is not None and job_id in (None, self._present.job_id):
                self._present.future.cancel()

    def close(self) -> None:
        """End the process."""
        self._discard_pool()

    def close_pipe(self) -> None:
        """Close the pipe of the reports, once nobody reads it any more."""
        self._reports_writer.close()
        self.reports.close()

    def _run_once(self, job: ClaimedJob, module: str, wanted: Callable[[], bool]) -> Outcome:
        limit = self._settings.job_time_limit_seconds
        arguments = (module, job.payload, job.id, job.attempt, new_identifier())
        future = self._working_pool().schedule(run_task, args=arguments, timeout=limit)
        with self._lock:
            self._present = _Present(job.id, future)
        try:
            if not wanted():
                future.cancel()
            return self._outcome(future, limit + SECONDS_OF_GRACE)
        finally:
            with self._lock:
                self._present = None

    def _outcome(self, future: "ProcessFuture[TaskOutcome]", seconds: float) -> Outcome:
        try:
            return future.result(seconds)
        except CancelledError:
            return Ended()
        except TimeoutError:
            if not future.done():
                self._discard_pool()
            return TimedOut()
        except ProcessExpired as expired:
            return Crashed(expired.exitcode)
        except BrokenProcessPool:
            raise
        except Exception as error:
            return Faulted(repr(error))

    def _working_pool(self) -> ProcessPool:
        if self._pool is not None and not self._pool.active:
            self._discard_pool()
        if self._pool is None:
            self._pool = self._new_pool()
        return self._pool

    def _new_pool(self) -> ProcessPool:
        settings = self._settings
        options = ChildOptions(
            os.getpid(),
            settings.job_memory_limit_bytes,
            settings.arrays_dir.resolve(),
            settings.max_array_bytes,
            settings.disk_reserve_bytes,
        )
        return ProcessPool(
            max_workers=1,
            max_tasks=settings.jobs_per_child,
            initializer=initialize,
            initargs=(options, self._reports_writer),
            context=self._context,
        )

    def _discard_pool(self) -> None:
        pool, self._pool = self._pool, None
        if pool is not None:
            pool.stop()
            pool.join()
