"""Which servers live, where several share a database; what a dead one ran is queued again."""

import logging
import os
import socket
from datetime import datetime, timedelta
from threading import Event, Thread

from sqlalchemy import delete, func, select

from app.jobs.executor import LocalExecutor
from app.jobs.journal import Journal
from app.store.database import Database
from app.store.rows import ServerRow

logger = logging.getLogger(__name__)
BEATS_PER_LEASE = 4
FORGOTTEN_AFTER = timedelta(days=1)


class Leases:
    """A thread that says that this server lives, by the clock of the database, and takes what others have left.

    A server that was not heard of for `seconds` is dead: its runs are queued again, and whatever it may still report
    of them is ignored, since a run is known by its attempt.
    """

    def __init__(
        self, database: Database, journal: Journal, executor: LocalExecutor, server: str, seconds: float, attempts: int
    ) -> None:
        self._database = database
        self._journal = journal
        self._executor = executor
        self._server = server
        self._lease = timedelta(seconds=seconds)
        self._attempts = attempts
        self._stopping = Event()
        self._thread = Thread(target=self._loop, name="lpv-oed-leases", daemon=True)

    def start(self) -> None:
        """Take part; raises when the database cannot be reached."""
        self.beat()
        self._thread.start()

    def stop(self) -> None:
        """Take no part any more, so that nobody waits for the end of the lease."""
        self._stopping.set()
        try:
            with self._database.write() as session:
                session.execute(delete(ServerRow).where(ServerRow.id == self._server))
        except Exception as error:
            logger.warning("this server could not sign off: %s", error)

    def beat(self) -> None:
        """Say that this server lives, take what dead ones ran, and end what is no longer to be run here."""
        self._journal.recover(self._attempts, self._living())
        self._executor.end_lost()

    def _loop(self) -> None:
        while not self._stopping.wait(self._lease.total_seconds() / BEATS_PER_LEASE):
            try:
                self.beat()
            except Exception as error:
                logger.warning("the lease of this server could not be renewed; trying again: %s", error)

    def _living(self) -> list[str]:
        with self._database.write() as session:
            now = session.scalars(select(func.now())).one()
            row = session.get(ServerRow, self._server) or ServerRow(id=self._server, name=_name(), started_at=now)
            row.seen_at = now
            session.add(row)
            session.execute(delete(ServerRow).where(ServerRow.seen_at < _before(now, FORGOTTEN_AFTER)))
            session.flush()
            return list(session.scalars(select(ServerRow.id).where(ServerRow.seen_at > _before(now, self._lease))))


def _before(now: datetime, time: timedelta) -> datetime:
    return now - time


def _name() -> str:
    return f"{socket.gethostname()} {os.getpid()}"
