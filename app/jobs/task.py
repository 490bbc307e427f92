"""What a kind of job is written against: `run(payload, context) -> TaskResult` in a module of its own."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from app.jobs.outcomes import Made
from app.store.arrays import ArrayStore

SECONDS_BETWEEN_REPORTS = 0.25
LONGEST_MESSAGE = 300


@dataclass(frozen=True)
class TaskResult:
    """What a job made: the document of the new resource (plain JSON, no NaN) and the hash of its arrays.

    `beside`: further resources, kept together with it, before it and in this order; its document should name them.
    """

    document: dict[str, Any]
    arrays: str | None = None
    beside: tuple[Made, ...] = ()


@dataclass
class TaskContext:
    """What a running job may use: array files, and a way to say how far it is."""

    arrays: ArrayStore
    report: Callable[[float, str], None] = lambda fraction, message: None
    _last_report: float = field(default=float("-inf"), init=False, repr=False)

    def progress(self, fraction: float, message: str) -> None:
        """Say how far the job is: a fraction in [0, 1] and a few words. Calls in quick succession are dropped."""
        now = time.monotonic()
        if now - self._last_report >= SECONDS_BETWEEN_REPORTS:
            self._last_report = now
            self.report(min(max(float(fraction), 0.0), 1.0), message[:LONGEST_MESSAGE])


class TaskModule(Protocol):
    """A module of a task package: its name is its `KIND`.

    `run` raises `identification.errors.MisuseError` when the request cannot be answered as it stands; any other
    exception is a fault of the service. `context.arrays.put` what is large and name its hash in the result.
    """

    KIND: str

    def run(self, payload: dict[str, Any], context: TaskContext) -> TaskResult:
        """Do the work of one job, from plain data alone."""
        ...
