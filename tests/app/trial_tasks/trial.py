"""A job that counts in small steps, then ends as it is told."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import eigh

from app.jobs.task import TaskContext, TaskResult
from identification.errors import MisuseError

KIND = "trial"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    steps = payload.get("steps", 1)
    if "note" in payload:
        note = Path(payload["note"])
        note.with_suffix(".part").write_text(str(os.getpid()))
        note.with_suffix(".part").rename(note)
    for step in range(steps):
        context.progress(step / steps, f"step {step + 1} of {steps} ✓")
        time.sleep(payload.get("seconds", 0.0) / steps)
        _wait_for(payload.get("pace"), str(step))
    _wait_for(payload.get("hold"))
    return _END[payload.get("end", "return")](payload, context)


def _wait_for(place: str | None, name: str = "") -> None:
    """Go on once there is such a file; at once where there is no `place`."""
    while place is not None and not Path(place, name).exists():
        time.sleep(0.02)


def _succeed(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    digest = context.arrays.put({"count": np.arange(payload.get("steps", 1))})
    return TaskResult({"name": payload.get("name", ""), "pid": os.getpid()}, digest)


def _misuse(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    raise MisuseError("give more operating points", "operating_points")


def _fault(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    raise KeyError("a secret of the inside")


def _hoard(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    hoard = [np.ones(2**24) for _ in range(2**10)]
    return TaskResult({"size": len(hoard)})


def _solve(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Linear algebra with hardly any memory left: whatever copy of BLAS it calls, it must come to an end."""
    matrix = np.eye(100)
    hoard: list[Any] = []
    for size in (2**24, 2**20, 2**17):
        try:
            while True:
                hoard.append(np.ones(size // 8))
        except MemoryError:
            continue
    hoard.clear() if len(hoard) < 2 else hoard.pop()
    return TaskResult({"trace": float(np.trace(matrix @ matrix) + eigh(matrix, eigvals_only=True).sum())})


def _kill(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def _abort(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    os.abort()


def _exit(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    sys.exit(0)


def _no_number(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    return TaskResult({"value": float("nan")})


_END = {
    "solve": _solve,
    "return": _succeed,
    "misuse": _misuse,
    "fault": _fault,
    "hoard": _hoard,
    "kill": _kill,
    "abort": _abort,
    "exit": _exit,
    "no number": _no_number,
}
