"""What tests of jobs do again and again."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from fastapi.testclient import TestClient

from app.container import Container
from app.jobs.records import JobRecord
from tests.support.patience import until


@dataclass(frozen=True)
class Bench:
    """A running application, its parts, and trial jobs to run on it."""

    client: TestClient
    container: Container

    def submit(self, key: str | None = None, fingerprint: str | None = None, **payload: Any) -> JobRecord:
        """Submit a trial job with this payload."""
        return self.container.ledger.submit(
            "trial", payload, "trials", idempotency_key=key, request_fingerprint=fingerprint
        )

    def wait(self, job: JobRecord, *states: str) -> dict[str, Any]:
        """The job over HTTP once it is in one of `states`, by default once it has finished."""
        wanted = states or ("succeeded", "failed", "cancelled")
        return until(lambda: self._in_state(job.id, wanted), lambda: f"{wanted}: {self.look(job.id)}")

    def look(self, job_id: str) -> dict[str, Any]:
        """The job over HTTP."""
        document: dict[str, Any] = self.client.get(f"/v1/jobs/{job_id}").json()
        return document

    def _in_state(self, job_id: str, wanted: Sequence[str]) -> dict[str, Any] | None:
        document = self.look(job_id)
        return document if document["state"] in wanted else None

    def run(self, **payload: Any) -> dict[str, Any]:
        """Submit a trial job and wait until it has finished."""
        return self.wait(self.submit(**payload))
