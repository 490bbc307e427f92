"""Faults of the service and of the place where it keeps things: what is answered, and that it goes on afterwards."""

import errno
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from app.main import create_app
from app.settings import Settings
from app.store.faults import StorageFullError, fault_of


def application(settings: Settings) -> FastAPI:
    made = create_app(settings)

    @made.get("/fail/{how}")
    def fail(how: str) -> None:
        if how == "full":
            raise OSError(errno.ENOSPC, "No space left on device")
        if how == "cause":
            raise ValueError("in vain") from StorageFullError("no room")
        raise KeyError("a secret of the inside")

    @made.post("/body")
    def body(content: dict[str, Any]) -> int:
        return len(content)

    return made


@pytest.fixture
def trial(settings: Settings) -> TestClient:
    return TestClient(application(settings), base_url="http://127.0.0.1")


@pytest.mark.parametrize(("how", "status"), [("full", 507), ("cause", 507), ("otherwise", 500)])
def test_a_fault_is_one_problem_and_no_more(trial: TestClient, how: str, status: int) -> None:
    with trial:
        answer = trial.get(f"/fail/{how}")  # the test client raises what the application does not answer
        assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")
        assert "secret" not in answer.text
        assert "connection" not in answer.headers
        if status == 507:
            assert "LPV_OED_DATA_DIR" in answer.json()["detail"]


BODIES = {
    "no JSON in UTF-8: byte 6": b'{"a": \xff}',
    "nested too deeply": b'{"a": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    "integer of too many digits": b'{"a": ' + b"1" * 10_000 + b"}",
    "no JSON: Expecting": b'{"a": }',
}


@pytest.mark.parametrize("expected", list(BODIES))
def test_each_body_that_cannot_be_read_says_why(trial: TestClient, expected: str) -> None:
    with trial:
        answer = trial.post("/body", content=BODIES[expected], headers={"Content-Type": "application/json"})
    assert answer.status_code == 400
    assert expected in answer.json()["detail"]


def test_readiness_says_that_the_disk_is_full_and_health_that_the_process_lives(settings: Settings) -> None:
    full = settings.model_copy(update={"disk_reserve_bytes": 2**60})
    with TestClient(application(full), base_url="http://127.0.0.1") as client:
        assert client.get("/v1/health").status_code == 200
        answer = client.get("/v1/readiness")
        assert (answer.status_code, answer.json()["type"]) == (503, "urn:lpv-oed:problem:service-unavailable")
        assert "LPV_OED_DISK_RESERVE_BYTES" in answer.json()["detail"]
    with TestClient(application(settings), base_url="http://127.0.0.1") as client:
        assert client.get("/v1/readiness").json()["status"] == "ready"


def damage(settings: Settings) -> None:
    """Overwrite pages in the middle of the database."""
    path = settings.data_dir / "lpv-oed.sqlite"
    content = bytearray(path.read_bytes())
    content[8 * 4096 : 40 * 4096] = b"\xa5" * (32 * 4096)
    path.write_bytes(content)


def test_readiness_says_that_the_database_is_damaged_and_so_does_the_next_start(
    settings: Settings, repository: Path
) -> None:
    with TestClient(application(settings), base_url="http://127.0.0.1") as client:
        container = client.app.state.container  # type: ignore[attr-defined]
        for number in range(200):
            container.resources.add("plants", {"filling": "x" * 900, "number": number})
        container.database.close()  # so that all is in the file, and in no cache
        damage(settings)
        assert client.get("/v1/health").status_code == 200
        answer = client.get("/v1/readiness")
        assert answer.status_code == 503
        assert "damaged" in answer.json()["detail"]
        assert "lpv-oed restore" in answer.json()["detail"]
    environment = {**os.environ, "PYTHONPATH": str(repository), "LPV_OED_DATA_DIR": str(settings.data_dir)}
    command = [sys.executable, "-m", "app.serve"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "restore a backup with lpv-oed restore" in done.stderr


def test_what_is_about_something_else_is_no_fault_of_the_place() -> None:
    assert fault_of(ValueError("disk full")) is None
    assert fault_of(OSError(errno.EACCES, "no")) is None


def test_identifiers_go_on_growing_though_the_clock_is_set_back(
    settings: Settings, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import app.store.identifiers as identifiers

    def named(client: TestClient) -> list[str]:
        return [plant["id"] for plant in client.get("/v1/plants").json()["items"]]

    plant = {
        "name": "a",
        "schedulingVariables": [{"name": "p", "minimum": 0.0, "maximum": 1.0}],
        "input": {"name": "u"},
        "output": {"name": "y"},
        "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 1, "nb": 0, "nk": 1},
        "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
    }
    made: list[str] = []
    now = identifiers.time.time_ns()
    for days_back in (0, 2, 4):
        monkeypatch.setattr(identifiers, "_clock", identifiers._Clock())
        monkeypatch.setattr(identifiers.time, "time_ns", lambda back=days_back: now - back * 86_400 * 10**9)
        with TestClient(create_app(settings), base_url="http://127.0.0.1") as client:
            made += [client.post("/v1/plants", json=plant).json()["id"] for _ in range(2)]
            assert named(client) == made[::-1]
