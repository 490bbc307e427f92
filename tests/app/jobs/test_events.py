"""Job events as a stream: complete, in order, resumable, and over when the job is."""

import asyncio
import json
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from threading import Thread
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.jobs.hub import Hub
from app.jobs.records import JobEventRecord
from app.main import create_app
from app.services.job_events import JobEvents
from app.settings import Settings
from tests.app.jobs.bench import Bench
from tests.support.patience import PATIENCE, until


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


def test_only_watchers_of_the_job_are_woken() -> None:
    async def woken() -> list[bool]:
        hub = Hub()
        with hub.watching("a") as first, hub.watching("b") as second, hub.watching("a") as third:
            hub.notify("a", "c")
            await asyncio.sleep(0.01)
            states = [event.is_set() for event in (first, second, third)]
            hub.close()
            await asyncio.sleep(0.01)
            return [*states, second.is_set()]

    assert asyncio.run(woken()) == [True, False, True, True]


class CountingLedger:
    """Events of jobs, and how often they were read."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = names
        self.reads = 0

    def events(self, job_id: str, after: int) -> list[JobEventRecord]:
        self.reads += 1
        progress = {"progress": {"fraction": 0.0, "message": ""}, "attempts": 1, "result": None, "problem": None}
        now = datetime.now(UTC)
        given = [
            JobEventRecord(seq, job_id, now, name, {**progress, "state": name})  # type: ignore[arg-type]
            for seq, name in enumerate(self.names, start=1)
        ]
        return given[after : after + 1]


def streams(ledger: CountingLedger, count: int, most: int = 1000) -> list[bytes]:
    async def read(events: JobEvents) -> bytes:
        return b"".join([chunk async for chunk in events.watch("a")])

    async def all_of_them() -> list[bytes]:
        events = JobEvents(ledger, Hub(), most)  # type: ignore[arg-type]
        found = await asyncio.gather(*(read(events) for _ in range(count)))
        assert events.streams == 0
        return found

    return asyncio.run(all_of_them())


def test_what_happens_is_read_once_for_all_who_watch() -> None:
    ledger = CountingLedger(["queued", "queued", "cancelled"])
    found = streams(ledger, 300)
    assert ledger.reads == 3
    assert len(set(found)) == 1
    assert found[0].count(b"\r\n\r\n") == 3


def test_no_more_streams_are_kept_than_there_may_be(settings: Settings, tmp_path: Path) -> None:
    application = create_app(settings.model_copy(update={"max_event_streams": 1}))
    with TestClient(application, base_url="http://127.0.0.1") as client:
        small = Bench(client, application.state.container)
        job = small.submit(hold=str(tmp_path / "go"))
        with ThreadPoolExecutor(1) as pool:
            first = pool.submit(watch, small, job.id)
            until(lambda: small.container.job_events.streams == 1, "the first stream")
            answer = client.get(f"/v1/jobs/{job.id}/events")
            assert answer.status_code == 503
            assert "LPV_OED_MAX_EVENT_STREAMS" in answer.json()["detail"]
            (tmp_path / "go").touch()
            assert [event.name for event in first.result()][-1] == "succeeded"
        assert watch(small, job.id)
