"""Settings of the service, read from the environment (LPV_OED_…)."""

import ipaddress
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Self

from pydantic import Field, SecretStr, model_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

from app.telemetry.logs import LogFormat

MEBIBYTE = 1024 * 1024
GIBIBYTE = 1024 * MEBIBYTE
TOKEN = re.compile(r"[A-Za-z0-9._~+/=-]{16,}", re.ASCII)
LEAST_JOB_MEMORY = 512 * MEBIBYTE


class Settings(BaseSettings):
    """Everything that can be set; the defaults serve one user on this machine."""

    model_config = SettingsConfigDict(env_prefix="LPV_OED_", extra="ignore", frozen=True, hide_input_in_errors=True)

    data_dir: Path = Field(default=Path("lpv-oed-data"), description="directory of the database and the array files")
    host: str = Field(default="127.0.0.1", description="address to listen on; beyond loopback a token is required")
    port: int = Field(default=8000, ge=0, le=65535, description="port to listen on")
    token: SecretStr | None = Field(default=None, description="bearer token that every request must carry")
    database_url: str | None = Field(
        default=None,
        description="postgresql://… for several servers that share the data directory; default: SQLite in it",
    )
    workers: int = Field(
        default=2, ge=0, le=256, description="jobs that run at the same time; 0: lpv-oed worker runs them elsewhere"
    )
    job_time_limit_seconds: float = Field(default=3600.0, gt=0, description="a job that runs longer is ended")
    job_memory_limit_bytes: int = Field(
        default=4 * GIBIBYTE,
        ge=LEAST_JOB_MEMORY,
        description="address space of a job; its libraries alone take 430 MiB",
    )
    job_attempts: int = Field(default=100, ge=1, description="server deaths during one job after which it fails")
    job_kills: int = Field(default=5, ge=1, description="times that a job's process is killed after which it fails")
    jobs_per_child: int = Field(default=100, ge=1, description="jobs that one child process runs before it is replaced")
    task_packages: tuple[str, ...] = Field(default=("app.jobs.tasks",), description="packages with the kinds of jobs")
    disk_reserve_bytes: int = Field(
        default=64 * MEBIBYTE,
        ge=0,
        description="room on the disk of the data directory below which nothing is taken in",
    )
    max_body_bytes: int = Field(default=64 * MEBIBYTE, ge=1024, description="largest request body")
    lease_seconds: float = Field(
        default=20.0, gt=0, description="of several servers, one that is silent for so long is dead, and its jobs go on"
    )
    log_format: LogFormat = Field(default="text", description="lines of the log: text, or json with one object each")
    unused_days: float = Field(
        default=7.0,
        ge=0.01,
        description="days after which array files go that nothing names, as uploads of failed jobs",
    )
    max_event_streams: int = Field(default=1000, ge=1, description="streams of job events at the same time")
    request_seconds: float = Field(
        default=20.0, gt=0, description="time for the head of a request, and for its body beside a second per 16 KiB"
    )
    max_array_bytes: int = Field(default=GIBIBYTE, ge=1024, description="largest set of arrays kept as one file")

    @model_validator(mode="after")
    def _beyond_loopback_only_with_token(self) -> Self:
        if self.token is not None and not TOKEN.fullmatch(self.token.get_secret_value()):
            raise ValueError(
                "LPV_OED_TOKEN must be 16 letters, digits or any of -._~+/= or more, without blanks, such as"
                " openssl rand -hex 16 gives; or leave it out"
            )
        if self.token is None and not is_loopback(self.host):
            raise ValueError(
                f"refusing to listen on {self.host} without authentication; "
                "set LPV_OED_TOKEN, or LPV_OED_HOST=127.0.0.1"
            )
        return self

    @model_validator(mode="after")
    def _database_is_known(self) -> Self:
        kind = (self.database_url or "sqlite").partition(":")[0].partition("+")[0]
        if kind not in ("sqlite", "postgresql", "postgres"):
            raise ValueError(f"LPV_OED_DATABASE_URL begins with {kind!r}; it must be postgresql://… or sqlite:///…")
        if kind != "sqlite" and find_spec("psycopg") is None:
            raise ValueError("LPV_OED_DATABASE_URL needs a driver: pip install 'lpv-oed[postgresql]'")
        if kind == "sqlite" and self.workers == 0:
            raise ValueError(
                "LPV_OED_WORKERS=0 leaves all jobs to workers, which need LPV_OED_DATABASE_URL=postgresql://…"
            )
        return self

    @property
    def arrays_dir(self) -> Path:
        return self.data_dir / "arrays"

    @property
    def resolved_database_url(self) -> str:
        """The database to use: the one that was set, else SQLite in the data directory."""
        return self.database_url or f"sqlite:///{self.data_dir.resolve() / 'lpv-oed.sqlite'}"

    @property
    def bearer_token(self) -> str | None:
        return None if self.token is None else self.token.get_secret_value()


def is_loopback(host: str) -> bool:
    """Whether `host` names this machine only."""
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host.lower() == "localhost"
