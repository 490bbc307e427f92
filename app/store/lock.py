"""One server per data directory."""

import fcntl
import time
from io import TextIOWrapper
from pathlib import Path

SECONDS_TO_WAIT = 2.0


class InUseError(RuntimeError):
    """Another server uses the directory."""


class DirectoryLock:
    """Held by the server that uses a directory; the system lets go of it when the process ends, however it ends."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._file: TextIOWrapper | None = None

    def acquire(self) -> None:
        """Take the lock; raises InUseError when another server keeps it."""
        self._file = (self._directory / "server.lock").open("w")
        deadline = time.monotonic() + SECONDS_TO_WAIT
        while not self._try():
            if time.monotonic() > deadline:
                self.release()
                raise InUseError(f"another server uses {self._directory}; stop it or set another LPV_OED_DATA_DIR")
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
