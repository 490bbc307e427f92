"""Every way in which a job can end, each in a real child process."""

import os
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy.exc import OperationalError

from app.errors import ConflictError
from app.jobs.journal import Journal
from app.main import create_app
from app.settings import Settings
from tests.app.jobs.bench import Bench
from tests.support.patience import until


def is_there(pid: int) -> bool:
    """Whether a process lives; one that has ended and waits for its parent does not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_success_keeps_one_resource_and_its_arrays(bench: Bench) -> None:
    job = bench.submit(steps=3, name="first")
    document = bench.wait(job)
    assert document["state"] == "succeeded"
    assert document["progress"] == {"fraction": 1.0, "message": "done"}
    assert "problem" not in document
    assert document["attempts"] == 1
    assert document["createdAt"] <= document["startedAt"] <= document["finishedAt"]
    assert document["result"] == {"kind": "trials", "id": job.resource_id, "href": f"/v1/trials/{job.resource_id}"}
    resource = bench.container.resources.get("trials", document["result"]["id"])
    assert resource.job_id == job.id
    assert resource.document["name"] == "first"
    assert bench.container.arrays.get(resource.arrays or "")["count"].tolist() == [0, 1, 2]


def test_misuse_is_a_422_that_names_the_field(bench: Bench) -> None:
    document = bench.run(end="misuse")
    assert document["state"] == "failed"
    assert "result" not in document
    assert document["problem"]["status"] == 422
    assert document["problem"]["detail"] == "give more operating points"
    assert document["problem"]["errors"][0]["pointer"] == "/operatingPoints"


def test_fault_says_nothing_of_the_inside(bench: Bench, caplog: pytest.LogCaptureFixture) -> None:
    document = bench.run(end="fault")
    assert document["problem"]["status"] == 500
    assert "secret" not in str(document)
    assert "a secret of the inside" in caplog.text


@pytest.mark.parametrize("end", ["exit", "no number"])
def test_no_result_is_a_fault(bench: Bench, end: str) -> None:
    document = bench.run(end=end)
    assert document["state"] == "failed"
    assert document["problem"]["status"] == 500


def test_memory_limit_fails_the_job_and_says_what_to_change(bench: Bench) -> None:
    document = bench.run(end="hoard")
    assert document["state"] == "failed"
    assert document["problem"]["type"] == "urn:lpv-oed:problem:memory-limit"
    assert "512 MiB" in document["problem"]["detail"]
    assert "LPV_OED_JOB_MEMORY_LIMIT_BYTES" in document["problem"]["detail"]


def test_time_limit_ends_the_job_and_says_what_to_change(settings: Settings) -> None:
    limited = settings.model_copy(update={"job_time_limit_seconds": 0.5})
    application = create_app(limited)
    with TestClient(application, base_url="http://127.0.0.1") as client:
        document = Bench(client, application.state.container).run(seconds=3600.0, steps=1)
    assert document["problem"]["type"] == "urn:lpv-oed:problem:time-limit"
    assert "LPV_OED_JOB_TIME_LIMIT_SECONDS" in document["problem"]["detail"]


def test_killed_child_fails_its_job_and_no_other(bench: Bench, tmp_path: Path) -> None:
    other = bench.submit(hold=str(tmp_path / "go"), name="other")
    bench.wait(other, "running")
    document = bench.run(end="kill")
    assert document["state"] == "failed"
    assert document["problem"]["type"] == "urn:lpv-oed:problem:job-crashed"
    assert "signal 9" in document["problem"]["detail"]
    (tmp_path / "go").touch()
    assert bench.wait(other)["state"] == "succeeded"
    assert bench.run(name="next")["state"] == "succeeded"


def test_a_child_that_is_killed_from_outside_is_no_end_of_its_job(bench: Bench, tmp_path: Path) -> None:
    note = tmp_path / "pid"
    job = bench.submit(hold=str(tmp_path / "go"), note=str(note))
    until(note.exists, "the start of the task")
    os.kill(int(note.read_text()), 9)
    (tmp_path / "go").touch()
    document = bench.wait(job)
    assert (document["state"], document["attempts"]) == ("succeeded", 2)
    names = [event.name for event in bench.container.ledger.events(job.id) if event.name != "progress"]
    assert names == ["queued", "started", "requeued", "started", "succeeded"]


def test_an_input_that_crashes_its_reader_is_not_read_again(bench: Bench) -> None:
    document = bench.run(end="abort")
    assert (document["state"], document["attempts"]) == ("failed", 1)
    assert "signal 6" in document["problem"]["detail"]


def test_idle_child_that_was_killed_is_replaced(bench: Bench) -> None:
    pids = {_pid(bench, bench.run()) for _ in range(4)}
    for pid in pids:
        os.kill(pid, 9)
    until(lambda: not any(map(is_there, pids)), "the end of the children")
    for _ in range(3):
        document = bench.run()
        assert document["state"] == "succeeded", document
        assert _pid(bench, document) not in pids


def _pid(bench: Bench, document: dict[str, dict[str, str]]) -> int:
    resource = bench.container.resources.get("trials", document["result"]["id"])
    return int(resource.document["pid"])


def test_cancelling_a_running_job_ends_its_process(bench: Bench, tmp_path: Path) -> None:
    note = tmp_path / "pid"
    job = bench.submit(hold=str(tmp_path / "never"), note=str(note))
    bench.wait(job, "running")
    until(note.exists, "the start of the task")
    pid = int(note.read_text())
    assert is_there(pid)
    answer = bench.client.post(f"/v1/jobs/{job.id}/cancellation")
    assert answer.status_code == 200
    assert answer.json()["state"] == "cancelled"
    until(lambda: not is_there(pid), "the end of the child")
    assert bench.run()["state"] == "succeeded"
    assert bench.client.get(f"/v1/jobs/{job.id}").json()["state"] == "cancelled"
    assert bench.container.resources.find("trials", job.resource_id) is None


def test_cancelling_a_queued_job_keeps_it_from_starting(bench: Bench, tmp_path: Path) -> None:
    busy = [bench.submit(hold=str(tmp_path / "go")) for _ in range(bench.container.settings.workers)]
    queued = bench.submit(name="never")
    assert bench.client.post(f"/v1/jobs/{queued.id}/cancellation").json()["state"] == "cancelled"
    (tmp_path / "go").touch()
    for job in busy:
        assert bench.wait(job)["state"] == "succeeded"
    document = bench.wait(queued)
    assert (document["state"], document["attempts"], document.get("startedAt")) == ("cancelled", 0, None)
    names = [event.name for event in bench.container.ledger.events(queued.id)]
    assert names == ["queued", "cancelled"]


def test_cancelling_a_finished_job_is_a_conflict(bench: Bench) -> None:
    document = bench.run()
    answer = bench.client.post(f"/v1/jobs/{document['id']}/cancellation")
    assert answer.status_code == 409
    assert answer.headers["content-type"] == "application/problem+json"
    with pytest.raises(ConflictError, match="already succeeded"):
        bench.container.ledger.cancel(document["id"])


def test_progress_is_told_in_words_and_numbers(bench: Bench, tmp_path: Path) -> None:
    job = bench.submit(seconds=0.9, steps=3, pace=str(tmp_path))
    for step in range(3):
        until(lambda step=step: len(told(bench, job.id)) > step, f"step {step}")  # type: ignore[misc]
        (tmp_path / str(step)).touch()
    assert bench.wait(job)["state"] == "succeeded"
    progress = told(bench, job.id)
    assert [one["message"] for one in progress] == [f"step {number} of 3 ✓" for number in (1, 2, 3)]
    assert [one["fraction"] for one in progress] == pytest.approx([0, 1 / 3, 2 / 3])


def told(bench: Bench, job_id: str) -> list[dict[str, Any]]:
    """The progress of a job as it was written down."""
    return [event.data["progress"] for event in bench.container.ledger.events(job_id) if event.name == "progress"]


def test_list_filters_and_pages(bench: Bench) -> None:
    for _ in range(3):
        bench.run()
    first = bench.client.get("/v1/jobs", params={"state": "succeeded", "limit": 2}).json()
    second = bench.client.get(
        "/v1/jobs", params={"state": "succeeded", "limit": 2, "cursor": first["nextCursor"]}
    ).json()
    identifiers = [job["id"] for job in first["items"] + second["items"]]
    assert len(set(identifiers)) == len(identifiers) >= 3
    assert identifiers == sorted(identifiers, reverse=True)
    assert all(job["state"] == "succeeded" for job in first["items"])
    assert bench.container.ledger.list(limit=500).next_cursor is None


def test_a_job_goes_on_where_the_database_cannot_be_asked_whether_it_is_wanted(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*_: object) -> bool:
        raise OperationalError("SELECT", {}, ConnectionError("terminating connection"))

    monkeypatch.setattr(Journal, "is_running", gone)
    assert bench.run(steps=1, name="first")["state"] == "succeeded"
