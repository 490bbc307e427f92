"""Job events as a stream: complete, in order, resumable, and over when the job is."""

import json
from dataclasses import dataclass
from threading import Thread
from typing import Any

import pytest

from tests.app.jobs.bench import Bench
from tests.support.patience import PATIENCE


@dataclass(frozen=True)
class Sent:
    """One event as it came over the wire."""

    id: int
    name: str
    data: dict[str, Any]


def watch(bench: Bench, job_id: str, headers: dict[str, str] | None = None, **query: str) -> list[Sent]:
    answer = bench.client.get(f"/v1/jobs/{job_id}/events", headers=headers, params=query)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith("text/event-stream")
    blocks = [block for block in answer.text.replace("\r\n", "\n").split("\n\n") if block and block[0] != ":"]
    return [_parsed(dict(line.split(": ", 1) for line in block.split("\n"))) for block in blocks]


def _parsed(fields: dict[str, str]) -> Sent:
    return Sent(int(fields["id"]), fields["event"], json.loads(fields["data"]))


def test_the_whole_story_of_a_job_is_replayed(bench: Bench) -> None:
    job = bench.submit(seconds=1.2, steps=8)
    bench.wait(job)
    events = watch(bench, job.id)
    names = [event.name for event in events]
    assert names[:2] == ["queued", "started"]
    assert names[-1] == "succeeded"
    assert set(names[2:-1]) == {"progress"}
    assert [event.id for event in events] == sorted({event.id for event in events})
    assert all(event.data["sequence"] == event.id and event.data["name"] == event.name for event in events)
    assert all(event.data["jobId"] == job.id for event in events)
    assert events[-1].data["result"]["id"] == job.resource_id
    assert events[-1].data["state"] == "succeeded"


def test_a_stream_that_began_before_the_job_ends_with_it(bench: Bench) -> None:
    job = bench.submit(seconds=1.2, steps=8)
    live: list[Sent] = []
    watcher = Thread(target=lambda: live.extend(watch(bench, job.id)))
    watcher.start()
    watcher.join(PATIENCE)
    assert not watcher.is_alive()
    assert [event.name for event in live][-1] == "succeeded"
    assert live == watch(bench, job.id)


def test_replay_from_any_event_gives_the_rest(bench: Bench) -> None:
    job = bench.submit(seconds=0.8, steps=4)
    bench.wait(job)
    events = watch(bench, job.id)
    for count, event in enumerate(events, start=1):
        assert watch(bench, job.id, headers={"Last-Event-ID": str(event.id)}) == events[count:]
    assert watch(bench, job.id, lastEventId=str(events[0].id)) == events[1:]
    both = watch(bench, job.id, headers={"Last-Event-ID": str(events[1].id)}, lastEventId=str(events[0].id))
    assert both == events[2:]


def test_a_failed_job_ends_its_stream_with_the_problem(bench: Bench) -> None:
    job = bench.submit(end="misuse")
    last = watch(bench, job.id)[-1]
    assert (last.name, last.data["problem"]["status"]) == ("failed", 422)


@pytest.mark.parametrize("given", ["x", "-1", "1.5", "9" * 30, "", "１", " "])
def test_a_bad_last_event_id_is_a_problem(bench: Bench, given: str) -> None:
    job = bench.submit()
    answer = bench.client.get(f"/v1/jobs/{job.id}/events", params={"lastEventId": given})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/lastEventId"
    if given.isascii():
        answer = bench.client.get(f"/v1/jobs/{job.id}/events", headers={"Last-Event-ID": given})
        assert answer.status_code == 422
        assert answer.json()["errors"][0] | {"detail": ""} == {
            "pointer": "/Last-Event-ID",
            "detail": "",
            "location": "header",
        }


def test_events_of_an_unknown_job_are_not_found(bench: Bench) -> None:
    answer = bench.client.get("/v1/jobs/unknown/events")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"
