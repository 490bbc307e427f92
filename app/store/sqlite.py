"""All that is special about SQLite."""

import sqlite3
from typing import Any

from sqlalchemy import Connection, Engine, event

_PRAGMAS = ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON", "busy_timeout=30000")
WRITE_OPTION = "lpv_oed_write"


def prepare(engine: Engine) -> None:
    """Write-ahead log, full sync, foreign keys; transactions begun here and not by the driver.

    A connection with the execution option `WRITE_OPTION` begins IMMEDIATE: it waits for its turn before it reads,
    so what it read cannot have changed when it writes. Readers see one snapshot and never wait.
    """

    @event.listens_for(engine, "connect")
    def on_connect(connection: sqlite3.Connection, _record: Any) -> None:
        connection.isolation_level = None
        for pragma in _PRAGMAS:
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def on_begin(connection: Connection) -> None:
        writes = connection.get_execution_options().get(WRITE_OPTION, False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")
