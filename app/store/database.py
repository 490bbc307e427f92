"""The database: an engine, read sessions and write sessions."""

import json
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from threading import Lock
from typing import Any

from sqlalchemy import Engine, create_engine, func, select, text
from sqlalchemy.orm import Session

from app.store import postgres, sqlite
from app.store.migrate import upgrade
from app.store.rows import JobRow, ResourceRow


class Database:
    """Where the rows are. Thread-safe; call `migrate` once before use and `close` at the end."""

    def __init__(self, url: str) -> None:
        self.url = url
        self._engine = _create_engine(url)
        self._writing = self._engine.execution_options(**{sqlite.WRITE_OPTION: True})
        self._turn: AbstractContextManager[Any] = Lock() if self._engine.dialect.name == "sqlite" else nullcontext()

    def migrate(self) -> None:
        """Bring the tables to the newest version; does nothing when they are."""
        with self._turn, self._writing.begin() as connection:
            postgres.lock_for_migration(connection)
            upgrade(connection)

    @property
    def is_shared(self) -> bool:
        """Whether several servers may use it at the same time."""
        return self._engine.dialect.name == "postgresql"

    @contextmanager
    def read(self) -> Iterator[Session]:
        """A session to read from: one consistent snapshot, never blocked by a writer."""
        with Session(self._engine, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def write(self) -> Iterator[Session]:
        """A session to write with: one transaction, committed on return, rolled back on any exception."""
        with self._turn, Session(self._writing, expire_on_commit=False) as session, session.begin():
            yield session

    def newest_identifier(self) -> str | None:
        """The largest identifier that was ever given to a job or a resource."""
        with self.read() as session:
            found = [
                session.scalar(select(func.max(column))) for column in (JobRow.id, JobRow.resource_id, ResourceRow.id)
            ]
        return max(filter(None, found), default=None)

    def check(self) -> None:
        """Raise when the database does not answer."""
        with self._engine.connect() as connection:
            connection.execute(text("SELECT 1"))

    def damage(self) -> str | None:
        """What an examination of the file finds wrong, if anything; other databases examine themselves."""
        if self._engine.dialect.name != "sqlite":
            return None
        with self._engine.connect() as connection:
            found = str(connection.execute(text("PRAGMA quick_check(1)")).scalar())
        return None if found == "ok" else found.splitlines()[-1]

    def close(self) -> None:
        self._engine.dispose()


def _create_engine(url: str) -> Engine:
    dumps = partial(json.dumps, allow_nan=False, separators=(",", ":"))
    made = postgres.driver_url(url)
    if made.get_backend_name() == "postgresql":
        return create_engine(made, json_serializer=dumps, connect_args=postgres.CONNECTION, **postgres.POOL)
    engine = create_engine(made, json_serializer=dumps)
    if engine.dialect.name == "sqlite":
        sqlite.prepare(engine)
    return engine
