"""How a run can end, as data."""

import signal
from dataclasses import dataclass
from typing import Any

FROM_OUTSIDE = frozenset({signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP})


@dataclass(frozen=True)
class Made:
    """A further resource that a task has made: its collection, such as "models", and an identifier of its own."""

    kind: str
    identifier: str
    plant_id: str | None
    document: dict[str, Any]
    arrays: str | None = None


@dataclass(frozen=True)
class Succeeded:
    """The task returned."""

    document: dict[str, Any]
    arrays: str | None
    beside: tuple[Made, ...] = ()


@dataclass(frozen=True)
class Refused:
    """The task raised MisuseError: the request cannot be answered as it stands."""

    message: str
    field: str | None


@dataclass(frozen=True)
class OutOfMemory:
    """The task reached the memory limit."""


@dataclass(frozen=True)
class NoRoom:
    """What the task made could not be kept, because the disk is full."""


@dataclass(frozen=True)
class Faulted:
    """The task raised anything else."""

    traceback: str


@dataclass(frozen=True)
class TimedOut:
    """The child process was ended at the time limit."""


@dataclass(frozen=True)
class Crashed:
    """The child process ended in the middle of the task; a negative code is a signal, None unknown."""

    exit_code: int | None

    @property
    def from_outside(self) -> bool:
        """Whether someone ended the process, as an operator or the system short of memory does."""
        return self.exit_code is not None and -self.exit_code in FROM_OUTSIDE


@dataclass(frozen=True)
class Ended:
    """The child process was ended on purpose: the job was cancelled, or the server stops."""


TaskOutcome = Succeeded | Refused | OutOfMemory | NoRoom | Faulted
Outcome = TaskOutcome | TimedOut | Crashed | Ended
