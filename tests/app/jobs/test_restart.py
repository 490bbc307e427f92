"""Jobs across stops and starts of the server, and children that cannot even start."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.container import Container
from app.main import create_app
from app.settings import LEAST_JOB_MEMORY, Settings
from tests.app.conftest import TASK_PACKAGES
from tests.app.jobs.bench import Bench
from tests.app.jobs.test_outcomes import is_there
from tests.support.patience import until


def started(directory: Path, **given: Any) -> TestClient:
    settings = Settings(data_dir=directory, **({"task_packages": TASK_PACKAGES, "workers": 1} | given))
    return TestClient(create_app(settings), base_url="http://127.0.0.1")


def bench_of(client: TestClient) -> Bench:
    container: Container = client.app.state.container  # type: ignore[attr-defined]
    return Bench(client, container)


def test_a_stop_gives_running_jobs_back_and_the_next_start_goes_on(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    with started(tmp_path / "data") as client:
        bench = bench_of(client)
        long = bench.submit(hold=str(tmp_path / "never"), note=str(note))
        waiting = bench.submit(name="waiting")
        bench.wait(long, "running")
        until(note.exists, "the start of the task")
        pid = int(note.read_text())
    assert not is_there(pid)
    with started(tmp_path / "data") as client:
        bench = bench_of(client)
        assert bench.wait(long, "running")["attempts"] == 2
        names = [event.name for event in bench.container.ledger.events(long.id) if event.name != "progress"]
        assert names == ["queued", "started", "requeued", "started"]
        bench.container.ledger.cancel(long.id)
        assert bench.wait(waiting)["state"] == "succeeded"


def test_a_kind_that_is_gone_fails_its_jobs(tmp_path: Path) -> None:
    with started(tmp_path / "data") as client:
        bench = bench_of(client)
        bench.submit(hold=str(tmp_path / "never"))
        gone = bench.submit()
    with started(tmp_path / "data", task_packages=("app.jobs.tasks",)) as client:
        document = bench_of(client).wait(gone)
        assert document["state"] == "failed"
        assert "'trial'" in document["problem"]["detail"]


def broken_start(*_: Any) -> None:
    raise OSError("no such limit on this machine")


def test_a_child_that_cannot_start_fails_the_job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with started(tmp_path / "data") as client, monkeypatch.context() as patch:
        patch.setattr("app.jobs.child.initialize", broken_start)
        bench = bench_of(client)
        document = bench.run()
        assert document["state"] == "failed"
        assert document["problem"]["type"] == "urn:lpv-oed:problem:job-crashed"
        patch.undo()
        assert bench.run()["state"] == "succeeded"


LOADED = """
import sys
from pathlib import Path
from app.jobs import worker
from app.jobs.discovery import discover_kinds, load_task
worker.initialize(worker.ChildOptions(int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3]), 0), None)
worker.take_buffers()
for module in discover_kinds(("app.jobs.tasks",)).values():
    load_task(module)
print("loaded")
"""


def test_the_least_memory_limit_is_enough_for_every_kind_of_job(tmp_path: Path, repository: Path) -> None:
    command = [sys.executable, "-c", LOADED, str(os.getpid()), str(LEAST_JOB_MEMORY), str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(repository)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("loaded\n", 0), done.stderr


@pytest.mark.parametrize("end", ["solve", "hoard"])
def test_at_the_least_memory_limit_jobs_end(tmp_path: Path, end: str) -> None:
    with started(tmp_path / "data", job_memory_limit_bytes=LEAST_JOB_MEMORY) as client:
        document = bench_of(client).run(end=end)
    if end == "hoard":
        assert document["problem"]["type"] == "urn:lpv-oed:problem:memory-limit"
    else:
        assert document["state"] == "succeeded", document.get("problem")
