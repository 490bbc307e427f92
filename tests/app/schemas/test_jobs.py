"""What a job tells of itself."""

from datetime import UTC, datetime

import pytest

from app.jobs.records import JobRecord, JobState
from app.schemas.jobs import Job

LONG_AGO = datetime.fromtimestamp(0, UTC)


@pytest.mark.parametrize(("state", "made"), [("succeeded", "/v1/models/m"), ("running", None), ("failed", None)])
@pytest.mark.parametrize("plant", ["p", None])
def test_a_job_names_its_plant_always_and_what_it_made_when_it_has(
    state: JobState, made: str | None, plant: str | None
) -> None:
    record = JobRecord("j", "identification", state, "models", "m", plant, 0.5, "", 1, LONG_AGO, None, None, None)
    document = Job.of(record)
    assert document.plant_id == plant
    assert (document.result and document.result.href) == made
