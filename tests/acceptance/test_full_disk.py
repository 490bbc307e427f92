"""A disk that is really full: nothing is left behind, nothing acknowledged is lost, and it goes on by itself."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.kill_restart import DESIGN, MODEL, PLANT
from tests.support.api import Api
from tests.support.server import running_server

MEBIBYTE = 1024 * 1024
SETTINGS = {"LPV_OED_DISK_RESERVE_BYTES": str(8 * MEBIBYTE), "LPV_OED_WORKERS": "1"}


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 40 MiB of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=40m", "tmpfs", str(place)]
    if os.getuid() != 0 or subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("A DISK CANNOT BE FILLED HERE: mounting a small one needs root")
    try:
        yield place
    finally:
        subprocess.run(["umount", "--lazy", str(place)], check=True)


def fill(disk: Path, leave: int) -> Path:
    """A file that leaves so many bytes of the disk."""
    path = disk / "filling"
    free = os.statvfs(disk).f_bavail * os.statvfs(disk).f_frsize
    path.write_bytes(b"\0" * (free - leave))
    return path


def record(plant: str, size: int) -> dict[str, object]:
    values = [float(number) for number in range(size)]
    return {
        "plantId": plant,
        "kind": "timeRecord",
        "input": values,
        "output": values,
        "operatingPoint": [0.5],
        "sampleTimeSeconds": 1.0,
    }


def test_a_full_disk_refuses_and_waits_and_goes_on(small_disk: Path) -> None:
    with running_server(small_disk / "data", SETTINGS) as server:
        api = Api(server.url)
        plant = api.post("/plants", PLANT)["id"]
        model = api.post("/models/stated", MODEL | {"plantId": plant})["id"]
        filling = fill(small_disk, 4 * MEBIBYTE)
        answer = api.http.post("/experiments", json=record(plant, 1000))
        assert (answer.status_code, answer.headers["content-type"]) == (507, "application/problem+json")
        assert "LPV_OED_DATA_DIR" in answer.json()["detail"]
        kept = (path for path in (small_disk / "data" / "arrays").rglob("*") if path.is_file())
        assert [path for path in kept if path.suffix != ".lock"] == []
        assert api.http.get("/readiness").status_code == 503
        assert api.http.get("/health").status_code == 200
        job = api.post("/designs", DESIGN | {"plantId": plant, "modelId": model})
        assert api.get(f"/jobs/{job['id']}")["state"] == "queued"
        filling.unlink()
        assert api.finished(job)["attempts"] == 1
        assert api.http.get("/readiness").status_code == 200
        assert api.made("/experiments", record(plant, 1000))["kind"] == "timeRecord"
    assert "Traceback" not in server.log_text()


def test_what_was_acknowledged_survives_a_disk_without_a_byte(small_disk: Path) -> None:
    with running_server(small_disk / "data", SETTINGS) as server:
        api = Api(server.url)
        plant = api.post("/plants", PLANT)["id"]
        model = api.post("/models/stated", MODEL | {"plantId": plant})["id"]
        jobs = [api.post("/designs", DESIGN | {"plantId": plant, "modelId": model}) for _ in range(4)]
        filling = fill(small_disk, 0)
        statuses = {api.http.post("/plants", json=PLANT | {"name": "x" * 200}).status_code for _ in range(300)}
        assert statuses <= {201, 507}
        assert 507 in statuses
        assert all(api.http.get(f"/jobs/{job['id']}").status_code == 200 for job in jobs)
        filling.unlink()
        for job in jobs:
            assert api.finished(job)["result"]["kind"] == "designs"


def test_a_start_on_a_full_disk_says_what_to_do(small_disk: Path, repository: Path) -> None:
    fill(small_disk, 0)
    environment = {**os.environ, "PYTHONPATH": str(repository), "LPV_OED_DATA_DIR": str(small_disk / "data")}
    done = subprocess.run(
        [sys.executable, "-m", "app.serve"], env=environment | SETTINGS, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "disk of the data directory is full" in done.stderr
