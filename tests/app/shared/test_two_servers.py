"""Two real servers on one database and one folder: each answers for both, one goes on where the other was killed."""

import signal
from pathlib import Path

import httpx
import pytest

from benchmarks.kill_restart import DESIGN, MODEL, PLANT, processes_on
from tests.support.api import Api
from tests.support.patience import PATIENCE, until
from tests.support.postgres import Postgres
from tests.support.server import running_server, start_server

LONG = DESIGN | {
    "operatingPoints": {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 1.0, "count": 60}]},
    "spectrumFamily": {"kind": "fir", "degree": 30},
}


def test_one_goes_on_where_the_other_was_killed(postgres: Postgres, tmp_path: Path) -> None:
    settings = {
        "LPV_OED_DATABASE_URL": postgres.database(),
        "LPV_OED_LEASE_SECONDS": "2",
        "LPV_OED_WORKERS": "1",
    }
    data = tmp_path / "data"
    with running_server(data, settings) as first, running_server(data, settings) as second:
        api, other = Api(first.url), Api(second.url)
        plant = api.post("/plants", PLANT)["id"]
        model = other.post("/models/stated", MODEL | {"plantId": plant})["id"]
        jobs = [api.post("/designs", LONG | {"plantId": plant, "modelId": model}) for _ in range(6)]
        with httpx.stream("GET", f"{second.url}/v1/jobs/{jobs[0]['id']}/events", timeout=PATIENCE) as events:
            until(lambda: len(other.get("/jobs", state="running")["items"]) > 0, "the first jobs")
            first.kill()
            until(lambda: other.get("/jobs", state="running")["items"], "jobs on the other")
            names = [line for line in events.iter_lines() if line.startswith("event: ")]
        assert names[-1] == "event: succeeded"
        made = {other.finished(job)["result"]["id"] for job in jobs}
        assert made == {design["id"] for design in other.get("/designs", limit=50)["items"]}
        assert len(made) == len(jobs)
    until(lambda: not list(processes_on(data)), "the end of all processes")


def test_sqlite_refuses_a_second_server_and_says_what_to_do(tmp_path: Path) -> None:
    shared = {"LPV_OED_DATABASE_URL": f"sqlite:///{tmp_path / 'one.sqlite'}"}
    with running_server(tmp_path / "first", shared):
        for data in ("first", "second"):
            second = start_server(tmp_path / data, shared)
            assert second.process.wait() == 1
            assert "PostgreSQL" in second.log_text()
            assert "Traceback" not in second.log_text()


def test_without_its_database_a_server_lives_answers_and_comes_back(postgres: Postgres, tmp_path: Path) -> None:
    with running_server(tmp_path / "data", {"LPV_OED_DATABASE_URL": postgres.database()}) as server:
        api = Api(server.url)
        plant = api.post("/plants", PLANT)["id"]
        postgres.stop(signal.SIGQUIT)
        try:
            answer = api.http.get(f"/plants/{plant}")
            assert (answer.status_code, answer.headers["retry-after"]) == (503, "30")
            assert api.http.get("/health").status_code == 200
            assert "does not answer" in api.http.get("/readiness").json()["detail"]
        finally:
            postgres.start()
        assert until(lambda: api.http.get("/readiness").status_code == 200, "readiness")
        assert api.get(f"/plants/{plant}")["id"] == plant
    assert "Traceback" not in server.log_text()


def test_a_database_that_is_not_there_is_said_in_one_line(tmp_path: Path) -> None:
    pytest.importorskip("psycopg")
    server = start_server(tmp_path / "data", {"LPV_OED_DATABASE_URL": "postgresql://nobody@127.0.0.1:1/none"})
    assert server.process.wait() == 1
    assert "the database cannot be reached" in server.log_text()
    assert "Traceback" not in server.log_text()
