"""All that is special about PostgreSQL: several servers share it, and tell each other what happens to jobs."""

import logging
from collections.abc import Callable
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from sqlalchemy import URL, Connection, func, make_url, select, text
from sqlalchemy.orm import Session

if TYPE_CHECKING:
    from psycopg import Connection as PsycopgConnection

logger = logging.getLogger(__name__)
CHANNEL = "lpv_oed_jobs"
MIGRATION_LOCK = 0x6C70765F6F6564  # one server at a time brings the tables up to date
POOL = {"pool_pre_ping": True, "pool_size": 10, "max_overflow": 40, "pool_timeout": 10}
CONNECTION = {"connect_timeout": 5, "keepalives_idle": 10, "keepalives_interval": 5, "tcp_user_timeout": 15_000}
SECONDS_BETWEEN_TRIES = 1.0


def driver_url(url: str) -> URL:
    """The address of a database with the driver that is used for it."""
    made = make_url(url)
    return made.set(drivername="postgresql+psycopg") if made.drivername in ("postgresql", "postgres") else made


def lock_for_migration(connection: Connection) -> None:
    """Wait until no other server brings the tables up to date, until the end of the transaction."""
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": MIGRATION_LOCK})


def announce(session: Session, job_id: str, event: str) -> None:
    """Tell all servers of an event of a job, when the transaction of `session` is committed."""
    if session.get_bind().dialect.name == "postgresql":
        session.execute(select(func.pg_notify(CHANNEL, f"{job_id} {event}")))


class Listener:
    """A thread that hears of what other servers announce; connects again for as long as it takes."""

    def __init__(self, url: str, heard: Callable[[str, str], None]) -> None:
        self._url = driver_url(url).set(drivername="postgresql").render_as_string(hide_password=False)
        self._heard = heard
        self._stopping = Event()
        self._thread = Thread(target=self._loop, name="lpv-oed-listener", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        self._stopping.set()
        self._thread.join(2 * SECONDS_BETWEEN_TRIES)

    def _loop(self) -> None:
        while not self._stopping.is_set():
            try:
                self._listen()
            except Exception as error:
                logger.warning("other servers cannot be heard; trying again: %s", error)
                self._stopping.wait(SECONDS_BETWEEN_TRIES)

    def _listen(self) -> None:
        from psycopg import connect

        options: dict[str, Any] = dict(CONNECTION)
        with connect(self._url, autocommit=True, **options) as connection:
            connection.execute(f"LISTEN {CHANNEL}")
            while not self._stopping.is_set():
                self._hear(connection)

    def _hear(self, connection: "PsycopgConnection[Any]") -> None:
        for notification in connection.notifies(timeout=SECONDS_BETWEEN_TRIES):
            job_id, _, event = notification.payload.partition(" ")
            self._heard(job_id, event)
