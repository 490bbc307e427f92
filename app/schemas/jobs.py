"""Documents of jobs."""

from typing import Self

from pydantic import Field

from app.jobs.records import EventName, JobEventRecord, JobRecord, JobState
from app.jobs.transitions import result_of
from app.schemas.common import CamelModel, Double, Integer, Problem, Timestamp


class JobProgress(CamelModel):
    """How far a job is."""

    fraction: Double = Field(ge=0, le=1, description="0 at the start, 1 when done")
    message: str = Field(description="the same in words")


class JobResult(CamelModel):
    """What a job made."""

    kind: str = Field(description="collection of the resource, such as models")
    id: str
    href: str = Field(description="where the resource is found")


class Job(CamelModel):
    """Work that takes a while."""

    id: str
    kind: str = Field(description="what is done, such as identification")
    state: JobState
    progress: JobProgress
    created_at: Timestamp
    started_at: Timestamp | None = None
    finished_at: Timestamp | None = None
    plant_id: str | None = Field(default=None, description="the plant it belongs to; null where it makes one")
    attempts: Integer = Field(
        description="how often it was started; more than once when a server or its process was killed"
    )
    result: JobResult | None = Field(default=None, description="what it made, once it has succeeded")
    problem: Problem | None = Field(default=None, description="why it failed, if it has")

    @classmethod
    def of(cls, record: JobRecord) -> Self:
        """The document of a job in the ledger."""
        result = result_of(record.state, record.resource_kind, record.resource_id)
        return cls(
            id=record.id,
            kind=record.kind,
            state=record.state,
            progress=JobProgress(fraction=record.fraction, message=record.message),
            created_at=record.created_at,
            started_at=record.started_at,
            finished_at=record.finished_at,
            plant_id=record.plant_id,
            attempts=record.attempts,
            result=JobResult.model_validate(result) if result else None,
            problem=Problem.model_validate(record.problem) if record.problem else None,
        )


class JobPage(CamelModel):
    """Part of the list of jobs, newest first."""

    items: list[Job]
    next_cursor: str | None = Field(default=None, description="continues the list; null at its end")


class JobEvent(CamelModel):
    """The data of one server-sent event of a job; its id is `sequence`, its event name is `name`."""

    sequence: Integer
    job_id: str
    at: Timestamp
    name: EventName
    state: JobState
    attempts: Integer
    progress: JobProgress
    result: JobResult | None = None
    problem: Problem | None = None

    @classmethod
    def of(cls, record: JobEventRecord) -> Self:
        """The document of an event in the ledger."""
        given = {"sequence": record.seq, "jobId": record.job_id, "at": record.at, "name": record.name}
        return cls.model_validate(given | record.data)
