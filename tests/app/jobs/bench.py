"""What tests of jobs do again and again."""

import time
from dataclasses import dataclass
from typing import Any

from fastapi.testclient import TestClient

from app.container import Container
from app.jobs.records import JobRecord


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

    def wait(self, job: JobRecord, *states: str, seconds: float = 15.0) -> dict[str, Any]:
        """The job over HTTP once it is in one of `states`, by default once it has finished."""
        wanted = states or ("succeeded", "failed", "cancelled")
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            document: dict[str, Any] = self.client.get(f"/v1/jobs/{job.id}").json()
            if document["state"] in wanted:
                return document
            time.sleep(0.02)
        raise AssertionError(f"after {seconds} s the job is {document}")

    def run(self, **payload: Any) -> dict[str, Any]:
        """Submit a trial job and wait until it has finished."""
        return self.wait(self.submit(**payload))
