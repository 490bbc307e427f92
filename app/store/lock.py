"""One server per file: the data directory, or the SQLite database."""

import fcntl
import time
from io import TextIOWrapper
from pathlib import Path

SECONDS_TO_WAIT = 2.0


class InUseError(RuntimeError):
    """Another server uses what this one was to use."""


class DirectoryLock:
    """Held by the server that uses a directory; the system lets go of it when the process ends, however it ends."""

    def __init__(self, directory: Path, name: str = "server.lock") -> None:
        self._directory = directory
        self._name = name
        self._file: TextIOWrapper | None = None

    def acquire(self) -> None:
        """Take the lock; raises InUseError when another server keeps it."""
        self._file = (self._directory / self._name).open("w")
        deadline = time.monotonic() + SECONDS_TO_WAIT
        while not self._try():
            if time.monotonic() > deadline:
                self.release()
                raise InUseError(
                    f"another server uses {self._directory}; stop it, or set another LPV_OED_DATA_DIR."
                    " Several servers need PostgreSQL: see LPV_OED_DATABASE_URL"
                )
            time.sleep(0.05)

    def release(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None

    def _try(self) -> bool:
        assert self._file is not None
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True


def locks_of(url: str, directory: Path) -> list[DirectoryLock]:
    """What a server must hold that uses this database and data directory."""
    if not url.startswith("sqlite"):
        return []
    place = Path(url.partition(":///")[2]).resolve()
    found = [DirectoryLock(directory)]
    return found if place.parent == directory.resolve() else [*found, DirectoryLock(place.parent, f"{place.name}.lock")]
