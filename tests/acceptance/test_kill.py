"""Stopped or killed while jobs run: nothing acknowledged is lost, nothing is made twice, no process is left over.

The full number of kills, and how fast the server is back, is in benchmarks/kill_restart.py.
"""

import signal
from pathlib import Path

import httpx
import pytest

from benchmarks.kill_restart import DESIGN, MODEL, PLANT, is_good, processes_on, run
from tests.support.patience import PATIENCE, until
from tests.support.server import running_server


@pytest.mark.slow
def test_nothing_is_lost_when_the_server_is_killed(tmp_path: Path) -> None:
    report = run(kills=5, seed=11, directory=tmp_path / "data")
    assert is_good(report), report
    assert report["states"] == {"succeeded": report["acknowledged"]}
    assert report["acknowledged"] >= 5


def test_a_stop_ends_open_streams_and_children(tmp_path: Path) -> None:
    with running_server(tmp_path / "data") as server, httpx.Client(base_url=server.url, timeout=PATIENCE) as client:
        plant = client.post("/v1/plants", json=PLANT).json()["id"]
        model = client.post("/v1/models/stated", json=MODEL | {"plantId": plant}).json()["id"]
        body = DESIGN | {"plantId": plant, "modelId": model}
        jobs = [client.post("/v1/designs", json=body).raise_for_status().json() for _ in range(30)]
        with client.stream("GET", f"/v1/jobs/{jobs[-1]['id']}/events") as stream:
            lines = stream.iter_lines()
            assert next(lines).startswith("id: ")
            server.process.send_signal(signal.SIGTERM)
            server.process.wait(timeout=PATIENCE)
    until(lambda: not list(processes_on(tmp_path / "data")), "the end of all processes")
    assert "Application shutdown complete" in server.log_text()
    assert "Traceback" not in server.log_text()
