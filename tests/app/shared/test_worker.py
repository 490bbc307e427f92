"""A server that runs no jobs itself, and workers that run them: killed, stopped, replaced."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.kill_restart import DESIGN, MODEL, PLANT, processes_on
from tests.app.shared.test_two_servers import LONG
from tests.support.api import Api
from tests.support.patience import PATIENCE, until
from tests.support.postgres import Postgres
from tests.support.server import ROOT, running_server, running_worker


def test_a_worker_runs_the_jobs_and_another_goes_on_where_it_was_killed(postgres: Postgres, tmp_path: Path) -> None:
    shared = {"LPV_OED_DATABASE_URL": postgres.database(), "LPV_OED_LEASE_SECONDS": "2"}
    data = tmp_path / "data"
    with running_server(data, shared | {"LPV_OED_WORKERS": "0"}) as server:
        api = Api(server.url)
        plant = api.post("/plants", PLANT)["id"]
        model = api.post("/models/stated", MODEL | {"plantId": plant})["id"]
        waiting = api.post("/designs", DESIGN | {"plantId": plant, "modelId": model})
        with running_worker(data, shared | {"LPV_OED_WORKERS": "1"}) as worker:
            assert api.finished(waiting)["state"] == "succeeded"
            long = api.post("/designs", LONG | {"plantId": plant, "modelId": model})
            until(lambda: api.get(f"/jobs/{long['id']}")["state"] == "running", "the long job on the worker")
            worker.kill()
        with running_worker(data, shared | {"LPV_OED_WORKERS": "1"}) as worker:
            assert api.finished(long)["state"] == "succeeded"
            worker.send_signal(signal.SIGTERM)
            assert worker.wait(timeout=PATIENCE) == 0
    until(lambda: not list(processes_on(data)), "the end of all processes")


@pytest.mark.parametrize(
    ("settings", "said"),
    [({}, "LPV_OED_DATABASE_URL"), ({"LPV_OED_WORKERS": "0"}, "LPV_OED_WORKERS=0")],
    ids=["no shared database", "nobody runs jobs"],
)
def test_a_worker_that_cannot_work_says_why(settings: dict[str, str], said: str, tmp_path: Path) -> None:
    environment = {"PYTHONPATH": str(ROOT), "LPV_OED_DATA_DIR": str(tmp_path), **settings}
    command = [sys.executable, "-m", "app.cli", "worker"]
    run = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert said in run.stderr
    assert "Traceback" not in run.stderr
