"""What every operation that starts a job needs."""

import hashlib
import json
from typing import Any

from fastapi import Response

from app.jobs.records import JobRecord
from app.schemas.jobs import Job


def fingerprint(operation: str, *parts: Any) -> str:
    """What tells one request from another under the same Idempotency-Key: the operation and all that was sent.

    `parts` are plain JSON, such as `body.model_dump(mode="json")`, or bytes, such as an uploaded file.
    """
    digest = hashlib.sha256(operation.encode())
    for part in parts:
        content = part if isinstance(part, bytes) else json.dumps(part, sort_keys=True, allow_nan=False).encode()
        digest.update(hashlib.sha256(content).digest())
    return digest.hexdigest()


def accepted(record: JobRecord, response: Response) -> Job:
    """The answer to a request that started a job: `Location` and the job. The route states status 202."""
    response.headers["Location"] = f"/v1/jobs/{record.id}"
    return Job.of(record)
