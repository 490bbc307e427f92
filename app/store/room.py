"""Room on the disk."""

import os
import time
from pathlib import Path

MORE_BYTES = 16 * 1024 * 1024
SECONDS_TO_TRY_AGAIN = 300.0


class Room:
    """How much of a disk is left; less than `reserve` is not enough. Thread-safe enough: a race costs one more try."""

    def __init__(self, directory: Path, reserve: int) -> None:
        self._directory = directory
        self._reserve = reserve
        self._wanted = 0
        self._wanted_until = 0.0

    def is_enough(self) -> bool:
        """Whether work may begin that keeps something."""
        wanted = self._wanted if time.monotonic() < self._wanted_until else 0
        return free_bytes(self._directory) >= max(self._reserve, wanted)

    def was_too_little(self) -> None:
        """What there is now was not enough: wait for more, or try again after a while."""
        self._wanted = free_bytes(self._directory) + MORE_BYTES
        self._wanted_until = time.monotonic() + SECONDS_TO_TRY_AGAIN


def free_bytes(directory: Path) -> int:
    """Bytes that a user without special rights can still write below a directory."""
    found = os.statvfs(directory)
    return found.f_bavail * found.f_frsize
