"""The ledger of jobs as executors see it: claim, report, finish. Every change is one transaction.

A run is known by the job and its attempt. Reports of a run that is no longer the present one (cancelled, or started
again after a crash) change nothing, so nothing can be recorded twice.
"""

from collections.abc import Collection, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import or_, select
from sqlalchemy.orm import Session

from app.jobs import problems
from app.jobs.hub import Hub
from app.jobs.outcomes import Made
from app.jobs.records import ClaimedJob
from app.jobs.transitions import move, tell
from app.store.database import Database
from app.store.resources import Resource, add_resource
from app.store.rows import JobRow

PATIENT_ATTEMPTS = 3
AGAIN = "waiting to be started again"
Run = tuple[str, int]
Progress = tuple[float, str]


class Journal:
    """Takes jobs from the ledger and writes down what became of them. Thread-safe."""

    def __init__(self, database: Database, hub: Hub, server: str | None = None) -> None:
        self._database = database
        self._hub = hub
        self._server = server

    def recover(self, most_attempts: int, living: Collection[str] = ()) -> int:
        """Queue again what was running on servers that are not `living`; returns how many jobs."""
        query = select(JobRow).where(JobRow.state == "running").order_by(JobRow.id).with_for_update(skip_locked=True)
        if living:
            query = query.where(or_(JobRow.server.is_(None), JobRow.server.not_in(living)))
        with self._database.write() as session:
            rows = session.scalars(query).all()
            for row in rows:
                _interrupted(session, row, most_attempts)
        self._hub.notify(*(row.id for row in rows))
        return len(rows)

    def claim(self) -> ClaimedJob | None:
        """Take the oldest queued job to run it, or None when there is none.

        Jobs that were interrupted again and again come last: should one of them be what brings the server down, the
        others are done before it is tried once more.
        """
        queued = select(JobRow).where(JobRow.state == "queued").limit(1)
        queued = queued.order_by(JobRow.attempts > PATIENT_ATTEMPTS, JobRow.id)
        with self._database.read() as session:
            if session.scalars(queued).first() is None:
                return None
        with self._database.write() as session:
            row = session.scalars(queued.with_for_update(skip_locked=True)).first()
            if row is None:
                return None
            row.attempts += 1
            row.server = self._server
            row.message = "started"
            move(session, row, "running")
            claimed = ClaimedJob(row.id, row.kind, row.attempts, row.payload)
        self._hub.notify(claimed.id)
        return claimed

    def is_running(self, run: Run) -> bool:
        """Whether this is still the present run of its job."""
        with self._database.read() as session:
            return _present(session, run) is not None

    def progress(self, reports: Mapping[Run, Progress]) -> None:
        """Write down how far runs are."""
        with self._database.write() as session:
            for run, (fraction, message) in reports.items():
                row = _present(session, run)
                if row is not None:
                    row.fraction, row.message = max(fraction, row.fraction), message
                    tell(session, row, "progress")
        self._hub.notify(*(job_id for job_id, _ in reports))

    def succeed(self, run: Run, document: dict[str, Any], arrays: str | None, beside: Sequence[Made] = ()) -> bool:
        """Keep what a run made and finish its job, together; False when it is no longer the present run."""
        with self._database.write() as session:
            row = _present(session, run)
            if row is not None:
                for made in beside:
                    add_resource(session, _beside(made))
                add_resource(session, _resource(row, document, arrays))
                row.fraction, row.message = 1.0, "done"
                move(session, row, "succeeded")
        self._hub.notify(run[0])
        return row is not None

    def fail(self, run: Run, problem: dict[str, Any]) -> bool:
        """Finish the job of a run with a problem; False when it is no longer the present run."""
        with self._database.write() as session:
            row = _present(session, run)
            if row is not None:
                _fail(session, row, problem)
        self._hub.notify(run[0])
        return row is not None

    def requeue(self, run: Run, message: str = AGAIN) -> None:
        """Give a job back that could not be finished, as when the server stops."""
        with self._database.write() as session:
            row = _present(session, run)
            if row is not None:
                _requeue(session, row, message)
        self._hub.notify(run[0])

    def killed(self, run: Run, signal: int, most_kills: int) -> None:
        """The process of a run was ended from outside: queue the job again, or fail it when that is one too many."""
        with self._database.write() as session:
            row = _present(session, run)
            if row is not None:
                row.kills += 1
                if row.kills >= most_kills:
                    _fail(session, row, problems.killed(signal, row.kills))
                else:
                    _requeue(session, row)
        self._hub.notify(run[0])


def _present(session: Session, run: Run) -> JobRow | None:
    job_id, attempt = run
    query = select(JobRow).where(JobRow.id == job_id, JobRow.state == "running", JobRow.attempts == attempt)
    return session.scalars(query.with_for_update()).one_or_none()


def _interrupted(session: Session, row: JobRow, most_attempts: int) -> None:
    if row.attempts >= most_attempts:
        _fail(session, row, problems.interrupted(row.attempts))
    else:
        _requeue(session, row)


def _requeue(session: Session, row: JobRow, message: str = AGAIN) -> None:
    row.fraction, row.message, row.server = 0.0, message, None
    move(session, row, "queued", event="requeued")


def _fail(session: Session, row: JobRow, problem: dict[str, Any]) -> None:
    row.problem = problem
    row.message = "failed"
    move(session, row, "failed")


def _beside(made: Made) -> Resource:
    return Resource(made.identifier, made.kind, made.plant_id, None, datetime.now(UTC), made.document, made.arrays)


def _resource(row: JobRow, document: dict[str, Any], arrays: str | None) -> Resource:
    now = datetime.now(UTC)
    return Resource(row.resource_id, row.resource_kind, row.plant_id, row.id, now, document, arrays)
