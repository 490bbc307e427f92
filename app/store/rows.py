"""The tables. `app/store/migrations` builds them; a test compares the two."""

from datetime import UTC, datetime
from typing import Any, ClassVar

from sqlalchemy import JSON, BigInteger, DateTime, Dialect, Float, ForeignKey, Index, Integer, String, Text
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.types import TypeDecorator


class UtcDateTime(TypeDecorator[datetime]):
    """Aware moments in UTC, also on databases that keep no time zone."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Base(DeclarativeBase):
    """Base of the tables."""

    type_annotation_map: ClassVar = {datetime: UtcDateTime(), dict[str, Any]: JSON()}


class JobRow(Base):
    """The ledger: one row for every job ever acknowledged."""

    __tablename__ = "jobs"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    kind: Mapped[str] = mapped_column(String(64))
    state: Mapped[str] = mapped_column(String(16))
    payload: Mapped[dict[str, Any]] = mapped_column(deferred=True)
    resource_kind: Mapped[str] = mapped_column(String(64))
    resource_id: Mapped[str] = mapped_column(String(32))
    plant_id: Mapped[str | None] = mapped_column(String(32))
    idempotency_key: Mapped[str | None] = mapped_column(String(255), unique=True)
    request_fingerprint: Mapped[str | None] = mapped_column(String(64))
    fraction: Mapped[float] = mapped_column(Float)
    message: Mapped[str] = mapped_column(Text)
    attempts: Mapped[int] = mapped_column(Integer)
    kills: Mapped[int] = mapped_column(Integer, server_default="0", default=0)
    server: Mapped[str | None] = mapped_column(String(32))
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    finished_at: Mapped[datetime | None]
    problem: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))

    __table_args__ = (Index("ix_jobs_state_id", "state", "id"),)


class ServerRow(Base):
    """A server that shares the database; what it runs is orphaned once it was not seen for the time of a lease."""

    __tablename__ = "servers"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    name: Mapped[str] = mapped_column(Text)
    started_at: Mapped[datetime]
    seen_at: Mapped[datetime]


class JobEventRow(Base):
    """What happened to a job; `seq` is the id of the server-sent event."""

    __tablename__ = "job_events"

    seq: Mapped[int] = mapped_column(BigInteger().with_variant(Integer, "sqlite"), primary_key=True, autoincrement=True)
    job_id: Mapped[str] = mapped_column(String(32), ForeignKey("jobs.id"))
    at: Mapped[datetime]
    name: Mapped[str] = mapped_column(String(32))
    data: Mapped[dict[str, Any]]

    __table_args__ = (Index("ix_job_events_job_id_seq", "job_id", "seq"), {"sqlite_autoincrement": True})


class TokenRow(Base):
    """Who may ask; of the token itself only its SHA-256 is kept, which nobody can turn back into it."""

    __tablename__ = "tokens"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    name: Mapped[str] = mapped_column(String(100))
    scope: Mapped[str] = mapped_column(String(16))
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    created_at: Mapped[datetime]
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]


class AuditRow(Base):
    """Who asked to make, change or end what, and what came of it."""

    __tablename__ = "audit"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    at: Mapped[datetime]
    who: Mapped[str] = mapped_column(String(100))
    method: Mapped[str] = mapped_column(String(16))
    path: Mapped[str] = mapped_column(Text)
    status: Mapped[int] = mapped_column(Integer)
    request_id: Mapped[str] = mapped_column(String(64))


class ResourceRow(Base):
    """Everything that was made: plants, experiments, models, designs, signals. New kinds need no migration."""

    __tablename__ = "resources"

    id: Mapped[str] = mapped_column(String(32), primary_key=True)
    kind: Mapped[str] = mapped_column(String(64))
    plant_id: Mapped[str | None] = mapped_column(String(32))
    job_id: Mapped[str | None] = mapped_column(String(32), ForeignKey("jobs.id"), unique=True)
    created_at: Mapped[datetime]
    document: Mapped[dict[str, Any]]
    arrays: Mapped[str | None] = mapped_column(String(64))
    deleted_at: Mapped[datetime | None]
    deleted_with: Mapped[str | None] = mapped_column(String(32))

    __table_args__ = (
        Index("ix_resources_kind_id", "kind", "id"),
        Index("ix_resources_kind_plant_id_id", "kind", "plant_id", "id"),
    )
