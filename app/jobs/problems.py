"""Why a job failed, as problem documents."""

from typing import Any

from app.errors import problem_type
from app.json_pointer import field_pointer
from app.schemas.common import FieldProblem, Problem


def _problem(
    slug: str, title: str, status: int, detail: str, errors: list[FieldProblem] | None = None
) -> dict[str, Any]:
    problem = Problem(type=problem_type(slug), title=title, status=status, detail=detail, errors=errors or [])
    return problem.model_dump(by_alias=True, exclude_none=True)


def misuse(message: str, field: str | None) -> dict[str, Any]:
    """The request cannot be answered as it stands."""
    errors = [FieldProblem(pointer=field_pointer(field), detail=message)] if field else []
    return _problem("invalid-request", "Invalid request", 422, message, errors)


def internal() -> dict[str, Any]:
    """A fault of the service."""
    detail = "the job ended with a fault of the service; the log of the server has the cause"
    return _problem("internal-error", "Internal error", 500, detail)


def timed_out(limit_seconds: float) -> dict[str, Any]:
    """The job ran longer than allowed."""
    detail = (
        f"the job was ended after its time limit of {limit_seconds:g} s; ask for less "
        "(fewer points, a lower degree, shorter records), or raise LPV_OED_JOB_TIME_LIMIT_SECONDS"
    )
    return _problem("time-limit", "Time limit reached", 500, detail)


def out_of_memory(limit_bytes: int) -> dict[str, Any]:
    """The job needed more memory than allowed."""
    detail = (
        f"the job needed more than its memory limit of {limit_bytes / 2**20:.0f} MiB; ask for less "
        "(fewer points, a lower degree, shorter records), or raise LPV_OED_JOB_MEMORY_LIMIT_BYTES"
    )
    return _problem("memory-limit", "Memory limit reached", 500, detail)


def killed(signal: int, times: int) -> dict[str, Any]:
    """The child process was ended from outside, again and again."""
    detail = (
        f"the process of the job was ended by signal {signal}, {times} times in all, as by a machine that is short of "
        "memory; run fewer jobs at a time (LPV_OED_WORKERS) or lower LPV_OED_JOB_MEMORY_LIMIT_BYTES, and submit it anew"
    )
    return _problem("job-crashed", "The job's process ended", 500, detail)


def crashed(exit_code: int | None, limit_bytes: int) -> dict[str, Any]:
    """The child process ended in the middle of the job."""
    how = f"by signal {-exit_code}" if exit_code is not None and exit_code < 0 else f"with exit code {exit_code}"
    detail = (
        f"the process of the job was ended {how}, so its input crashed a library or the machine ran out of memory "
        f"(the limit of a job is {limit_bytes / 2**20:.0f} MiB); other jobs are not affected"
    )
    return _problem("job-crashed", "The job's process ended", 500, detail)


def interrupted(attempts: int) -> dict[str, Any]:
    """The server died too often while the job ran."""
    detail = f"the server ended {attempts} times while this job ran, so it is not started again; submit it anew"
    return _problem("job-interrupted", "Interrupted too often", 500, detail)
