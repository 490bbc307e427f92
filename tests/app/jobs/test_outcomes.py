"""Every way in which a job can end, each in a real child process."""

import os
import time
from pathlib import Path

import pytest

from app.errors import ConflictError
from tests.app.jobs.bench import Bench


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
    assert document["problem"] is None
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
    assert document["result"] is None
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


def test_time_limit_ends_the_job_and_says_what_to_change(bench: Bench) -> None:
    document = bench.run(seconds=60.0, steps=1)
    assert document["problem"]["type"] == "urn:lpv-oed:problem:time-limit"
    assert "LPV_OED_JOB_TIME_LIMIT_SECONDS" in document["problem"]["detail"]


def test_killed_child_fails_its_job_and_no_other(bench: Bench) -> None:
    other = bench.submit(seconds=1.5, steps=10, name="other")
    bench.wait(other, "running")
    document = bench.run(end="kill")
    assert document["state"] == "failed"
    assert document["problem"]["type"] == "urn:lpv-oed:problem:job-crashed"
    assert "signal 9" in document["problem"]["detail"]
    assert bench.wait(other)["state"] == "succeeded"
    assert bench.run(name="next")["state"] == "succeeded"


def test_idle_child_that_was_killed_is_replaced(bench: Bench) -> None:
    pids = {_pid(bench, bench.run()) for _ in range(4)}
    for pid in pids:
        os.kill(pid, 9)
    time.sleep(0.3)
    for _ in range(3):
        document = bench.run()
        assert document["state"] == "succeeded", document
        assert _pid(bench, document) not in pids


def _pid(bench: Bench, document: dict[str, dict[str, str]]) -> int:
    resource = bench.container.resources.get("trials", document["result"]["id"])
    return int(resource.document["pid"])


def test_cancelling_a_running_job_ends_its_process(bench: Bench, tmp_path: Path) -> None:
    note = tmp_path / "pid"
    job = bench.submit(seconds=60.0, steps=600, note=str(note))
    bench.wait(job, "running")
    while not note.exists():
        time.sleep(0.02)
    pid = int(note.read_text())
    assert is_there(pid)
    answer = bench.client.post(f"/v1/jobs/{job.id}/cancellation")
    assert answer.status_code == 200
    assert answer.json()["state"] == "cancelled"
    deadline = time.monotonic() + 2
    while is_there(pid) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not is_there(pid)
    assert bench.run()["state"] == "succeeded"
    assert bench.client.get(f"/v1/jobs/{job.id}").json()["state"] == "cancelled"
    assert bench.container.resources.find("trials", job.resource_id) is None


def test_cancelling_a_queued_job_keeps_it_from_starting(bench: Bench) -> None:
    busy = [bench.submit(seconds=1.0, steps=5) for _ in range(bench.container.settings.workers)]
    queued = bench.submit(name="never")
    assert bench.client.post(f"/v1/jobs/{queued.id}/cancellation").json()["state"] == "cancelled"
    for job in busy:
        assert bench.wait(job)["state"] == "succeeded"
    document = bench.wait(queued)
    assert (document["state"], document["attempts"], document["startedAt"]) == ("cancelled", 0, None)
    names = [event.name for event in bench.container.ledger.events(queued.id)]
    assert names == ["queued", "cancelled"]


def test_cancelling_a_finished_job_is_a_conflict(bench: Bench) -> None:
    document = bench.run()
    answer = bench.client.post(f"/v1/jobs/{document['id']}/cancellation")
    assert answer.status_code == 409
    assert answer.headers["content-type"] == "application/problem+json"
    with pytest.raises(ConflictError, match="already succeeded"):
        bench.container.ledger.cancel(document["id"])


def test_progress_is_told_in_words_and_numbers(bench: Bench) -> None:
    job = bench.submit(seconds=1.5, steps=10)
    bench.wait(job)
    told = [event.data["progress"] for event in bench.container.ledger.events(job.id) if event.name == "progress"]
    fractions = [progress["fraction"] for progress in told]
    assert len(told) >= 3
    assert fractions == sorted(fractions)
    assert all(0 <= fraction < 1 for fraction in fractions)
    assert any(progress["message"].startswith("step ") and progress["message"].endswith("✓") for progress in told)


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
