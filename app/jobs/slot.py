"""A thread that takes jobs from the journal, one at a time, and runs each in its child process."""

import logging
from collections.abc import Mapping
from threading import Event, Thread

from app.jobs import problems
from app.jobs.child import Child
from app.jobs.journal import Journal, Run
from app.jobs.outcomes import Crashed, Ended, Faulted, NoRoom, Outcome, OutOfMemory, Refused, Succeeded, TimedOut
from app.jobs.records import ClaimedJob
from app.settings import Settings
from app.store.faults import fault_of
from app.store.room import Room
from app.telemetry.logs import about

logger = logging.getLogger(__name__)
SECONDS_BETWEEN_LOOKS = 2.0
SECONDS_AFTER_FAULT = 1.0


class Slot:
    """Room for one running job."""

    def __init__(self, journal: Journal, kinds: Mapping[str, str], settings: Settings, room: Room) -> None:
        self._journal = journal
        self._room = room
        self._kinds = kinds
        self._settings = settings
        self.child = Child(settings)
        self._present: Run | None = None
        self._awake = Event()
        self._stopping = Event()
        self._thread = Thread(target=self._loop, name="lpv-oed-job-slot", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def wake(self) -> None:
        """Look for a job now."""
        self._awake.set()

    def stop(self) -> None:
        """End the running job, which is queued again, and take no other."""
        self._stopping.set()
        self._awake.set()
        self.child.end()

    def join(self) -> None:
        """Wait until the child process has ended."""
        self._thread.join()

    def end_if_lost(self, job_id: str | None) -> None:
        """End the child process if its run, of this job or of any, was cancelled or taken over elsewhere."""
        run = self._present
        if run is not None and job_id in (None, run[0]) and not self._journal.is_running(run):
            self.child.end(run[0])

    def _loop(self) -> None:
        while not self._stopping.is_set():
            self._awake.clear()
            try:
                found = self._run_next()
            except Exception as error:
                _log(error, "the ledger could not be reached; trying again")
                self._stopping.wait(SECONDS_AFTER_FAULT)
                continue
            if not found:
                self._awake.wait(SECONDS_BETWEEN_LOOKS)
        self.child.close()

    def _run_next(self) -> bool:
        job = self._journal.claim() if self._room.is_enough() else None
        if job is None:
            return False
        self._present = (job.id, job.attempt)
        try:
            with about(jobId=job.id):
                self._record(job, self._run(job))
        finally:
            self._present = None
        return True

    def _run(self, job: ClaimedJob) -> Outcome:
        run = (job.id, job.attempt)
        module = self._kinds.get(job.kind)
        if module is None:
            return Refused(f"this server does not know the job kind {job.kind!r}", None)
        try:
            return self.child.run(job, module, lambda: self._is_wanted(run))
        except Exception as error:
            logger.exception("job %s could not be run", job.id)
            return Faulted(repr(error))

    def _is_wanted(self, run: Run) -> bool:
        """Whether a run is still the present one; it goes on where the database cannot be asked, and is ended later."""
        try:
            return not self._stopping.is_set() and self._journal.is_running(run)
        except Exception as error:
            if fault_of(error) is None:
                raise
            return not self._stopping.is_set()

    def _record(self, job: ClaimedJob, outcome: Outcome) -> None:
        while True:
            try:
                return self._write_down(job, outcome)
            except Exception as error:
                _log(error, f"the outcome of job {job.id} could not be written down; trying again")
                if fault_of(error) is None:  # it is about the outcome, not about the place where it is kept
                    outcome = Faulted(repr(error))
            if self._stopping.wait(SECONDS_AFTER_FAULT):
                return None  # still marked as running, so the next server starts it again

    def _write_down(self, job: ClaimedJob, outcome: Outcome) -> None:
        run = (job.id, job.attempt)
        memory_limit = self._settings.job_memory_limit_bytes
        match outcome:
            case Succeeded(document, arrays, beside):
                self._journal.succeed(run, document, arrays, beside)
            case Refused(message, field):
                self._journal.fail(run, problems.misuse(message, field))
            case OutOfMemory():
                self._journal.fail(run, problems.out_of_memory(memory_limit))
            case TimedOut():
                self._journal.fail(run, problems.timed_out(self._settings.job_time_limit_seconds))
            case NoRoom():
                self._room.was_too_little()
                self._journal.requeue(run, "waiting for room on the disk")
            case Crashed(int(exit_code)) if outcome.from_outside:
                logger.warning("the process of job %s (%s) was ended by signal %s", job.id, job.kind, -exit_code)
                self._journal.killed(run, -exit_code, self._settings.job_kills)
            case Crashed(exit_code):
                logger.error("the process of job %s (%s) ended with code %s", job.id, job.kind, exit_code)
                self._journal.fail(run, problems.crashed(exit_code, memory_limit))
            case Faulted(traceback):
                logger.error("job %s (%s) failed:\n%s", job.id, job.kind, traceback)
                self._journal.fail(run, problems.internal())
            case Ended():
                self._journal.requeue(run)


def _log(error: Exception, what: str) -> None:
    """Say what went wrong; where in the program only when the cause is not the disk or the database."""
    logger.error("%s: %s", what, error, exc_info=None if fault_of(error) else error)
