"""What is wrong with the place where things are kept: it is full, out of reach, or damaged."""

import errno
from collections.abc import Iterator
from typing import Literal

from sqlalchemy.exc import DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

Fault = Literal["full", "unreachable", "damaged"]
FULL_ERRORS = (errno.ENOSPC, errno.EDQUOT)
FULL = ("database or disk is full", "no space left on device", "disk full")
DAMAGED = ("malformed", "not a database", "could not read block", "invalid page")
BUSY = ("database is locked", "unable to open database", "disk i/o error")
OUT_OF_REACH = (OperationalError, InterfaceError)


class StorageFullError(OSError):
    """There is no room left for what was to be kept; nothing of it was."""

    def __init__(self, message: str) -> None:
        super().__init__(errno.ENOSPC, message)


def fault_of(error: BaseException) -> Fault | None:
    """What an error says of the place, also by what it was raised from; None when it is about something else."""
    return next((fault for one in _causes(error) if (fault := _fault(one)) is not None), None)


def is_full(error: BaseException) -> bool:
    """Whether an error says that there is no room left."""
    return fault_of(error) == "full"


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__


def _fault(error: BaseException) -> Fault | None:
    if isinstance(error, OSError) and error.errno in FULL_ERRORS:
        return "full"
    if isinstance(error, PoolTimeoutError):
        return "unreachable"
    if not isinstance(error, DBAPIError):
        return None
    return _database_fault(error)


def _database_fault(error: DBAPIError) -> Fault | None:
    text = str(error.orig).lower()
    if any(one in text for one in FULL):
        return "full"
    if any(one in text for one in DAMAGED):
        return "damaged"
    if type(error.orig).__module__ == "sqlite3":  # whose operational errors are also those of a wrong statement
        return "unreachable" if any(one in text for one in BUSY) else None
    return "unreachable" if error.connection_invalidated or isinstance(error, OUT_OF_REACH) else None
