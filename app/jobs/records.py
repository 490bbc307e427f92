"""What a job is: plain data, as the ledger hands it out."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

from typing_extensions import TypeAliasType

JobState = TypeAliasType("JobState", Literal["queued", "running", "succeeded", "failed", "cancelled"])
EventName = TypeAliasType(
    "EventName", Literal["queued", "started", "progress", "requeued", "succeeded", "failed", "cancelled"]
)

FINAL_STATES: frozenset[JobState] = frozenset({"succeeded", "failed", "cancelled"})


@dataclass(frozen=True)
class JobRecord:
    """One job. `resource_kind` and `resource_id` say what it makes, fixed at submission."""

    id: str
    kind: str
    state: JobState
    resource_kind: str
    resource_id: str
    plant_id: str | None
    fraction: float
    message: str
    attempts: int
    created_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    problem: dict[str, Any] | None

    @property
    def finished(self) -> bool:
        return self.state in FINAL_STATES


@dataclass(frozen=True)
class ClaimedJob:
    """A job that was taken to be run; `attempt` tells this run from earlier and later ones."""

    id: str
    kind: str
    attempt: int
    payload: dict[str, Any]


@dataclass(frozen=True)
class JobEventRecord:
    """Something that happened to a job; `seq` grows with time."""

    seq: int
    job_id: str
    at: datetime
    name: EventName
    data: dict[str, Any]
