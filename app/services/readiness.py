"""Why the service cannot take in work, if it cannot."""

import time
from pathlib import Path
from threading import Lock

from app.store.database import Database
from app.store.faults import fault_of
from app.store.room import free_bytes

SECONDS_BETWEEN_EXAMINATIONS = 60.0


class Readiness:
    """Looks at the disk and the database; whether the database is whole is examined once a minute at most."""

    def __init__(self, database: Database, directory: Path, reserve: int) -> None:
        self._database = database
        self._directory = directory
        self._reserve = reserve
        self._lock = Lock()
        self._examined = float("-inf")
        self._damage: str | None = None

    def reasons(self) -> list[str]:
        """Every reason against taking in work, each with what to do."""
        return [reason for reason in (self._room(), self._base()) if reason is not None]

    def _room(self) -> str | None:
        try:
            free = free_bytes(self._directory)
        except OSError as error:
            return f"the data directory cannot be looked at ({error.strerror}); mount it again"
        if free >= self._reserve:
            return None
        return (
            f"the disk of the data directory is full: {free >> 20} MiB are left, and LPV_OED_DISK_RESERVE_BYTES asks"
            f" for {self._reserve >> 20} MiB; free some room, and the jobs that wait go on by themselves"
        )

    def _base(self) -> str | None:
        try:
            self._database.check()
            damage = self._damage_found()
        except Exception as error:
            kind = fault_of(error)
            reason = "is damaged" if kind == "damaged" else "does not answer"
            return f"the database {reason} ({type(error).__name__})" + (RESTORE if kind == "damaged" else "")
        return None if damage is None else f"the database is damaged ({damage}){RESTORE}"

    def _damage_found(self) -> str | None:
        with self._lock:
            if time.monotonic() - self._examined > SECONDS_BETWEEN_EXAMINATIONS:
                self._damage = self._database.damage()
                self._examined = time.monotonic()
            return self._damage


RESTORE = "; stop the server and restore a backup with lpv-oed restore"
