"""What runs in the child processes. Imports nothing heavy before the limits are in place."""

import ctypes
import json
import os
import resource
import signal
import sys
import traceback
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.jobs.outcomes import Faulted, NoRoom, OutOfMemory, Refused, Succeeded, TaskOutcome

if TYPE_CHECKING:
    from app.jobs.task import TaskContext

ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True)
class ChildOptions:
    """What a child process is told when it starts."""

    parent: int
    memory_limit_bytes: int
    arrays_dir: Path
    max_array_bytes: int
    disk_reserve_bytes: int = 0


@dataclass(frozen=True)
class _Child:
    options: ChildOptions
    reports: "Connection[bytes, bytes]"


_child: _Child | None = None


def initialize(options: ChildOptions, reports: "Connection[bytes, bytes]") -> None:
    """Called once in a new child process: limits first, then nothing else until there is a job."""
    global _child
    _die_with_parent(options.parent)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    os.environ.update(ONE_THREAD)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (options.memory_limit_bytes, options.memory_limit_bytes))
    _child = _Child(options, reports)


def run_task(module: str, payload: dict[str, Any], job_id: str, attempt: int, newest: str) -> TaskOutcome:
    """Run one job; whatever happens in it comes back as data. Identifiers made in it are larger than `newest`."""
    try:
        return _run(module, payload, job_id, attempt, newest)
    except BaseException as error:
        return _outcome_of(error)


def take_buffers() -> None:
    """Let each copy of OpenBLAS take the memory that it works in.

    It does so at its first use and keeps it; where no memory is left by then, it tries again for ever.
    """
    import numpy as np
    from scipy.linalg.blas import dgemm

    square = np.eye(128)
    np.matmul(square, square)
    dgemm(1.0, square, square)


def _run(module: str, payload: dict[str, Any], job_id: str, attempt: int, newest: str) -> Succeeded:
    from app.jobs.discovery import load_task
    from app.store.identifiers import observe

    take_buffers()
    observe(newest)
    result = load_task(module).run(payload, _context(job_id, attempt))
    json.dumps([result.document, *(one.document for one in result.beside)], allow_nan=False)
    return Succeeded(result.document, result.arrays, result.beside)


def _outcome_of(error: BaseException) -> TaskOutcome:
    from app.store.faults import is_full
    from identification.errors import MisuseError

    if isinstance(error, MisuseError):
        return Refused(str(error), error.field)
    if isinstance(error, MemoryError) or _is_unmapped(error):
        return OutOfMemory()
    if is_full(error):
        return NoRoom()
    return Faulted("".join(traceback.format_exception(error)))


def _is_unmapped(error: BaseException) -> bool:
    """Whether a library could not be loaded because there was no memory for it."""
    return isinstance(error, ImportError) and ("failed to map" in str(error) or "annot allocate memory" in str(error))


def _context(job_id: str, attempt: int) -> "TaskContext":
    from app.jobs.task import TaskContext
    from app.store.arrays import ArrayStore

    assert _child is not None
    options, reports = _child.options, _child.reports

    def report(fraction: float, message: str) -> None:
        reports.send_bytes(json.dumps([job_id, attempt, fraction, message], ensure_ascii=False).encode())

    return TaskContext(ArrayStore(options.arrays_dir, options.max_array_bytes, options.disk_reserve_bytes), report)


def _die_with_parent(parent: int) -> None:
    """No child outlives its server, however that ends."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)
