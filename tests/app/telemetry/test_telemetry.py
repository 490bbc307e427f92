"""What an operator sees: a line for every request and job, and figures that Prometheus can read."""

import json
import logging
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from prometheus_client.parser import text_string_to_metric_families
from sqlalchemy.exc import OperationalError

from app.settings import Settings
from app.telemetry.logs import AboutFilter, TextFormatter, about
from benchmarks.kill_restart import DESIGN, MODEL, PLANT
from tests.support.api import Api
from tests.support.patience import until
from tests.support.server import running_server


def lines(text: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in text.splitlines()]


def test_lines_of_requests_and_jobs_find_each_other(tmp_path: Path) -> None:
    with running_server(tmp_path / "data", {"LPV_OED_LOG_FORMAT": "json"}) as server:
        api = Api(server.url)
        plant = api.post("/plants", PLANT)["id"]
        model = api.post("/models/stated", MODEL | {"plantId": plant})["id"]
        body = DESIGN | {"plantId": plant, "modelId": model}
        answer = httpx.post(f"{server.url}/v1/designs", json=body, headers={"X-Request-ID": "given-by-a-proxy"})
        assert answer.headers["x-request-id"] == "given-by-a-proxy"
        job = api.finished(answer.json())
        odd = httpx.get(f"{server.url}/v1/plants/%0Aforged", headers={"X-Request-ID": "a b\tc"})
        assert odd.headers["x-request-id"] not in ("a b\tc", "given-by-a-proxy")
        found = until(lambda: [one for one in lines(server.log_text()) if one.get("requestId") == "given-by-a-proxy"])
    submitted, answered = found
    assert job["id"] in submitted["message"]
    assert (answered["method"], answered["path"], answered["status"]) == ("POST", "/v1/designs", 202)
    assert answered["milliseconds"] > 0
    assert all({"time", "level", "logger", "message"} <= one.keys() for one in lines(server.log_text()))


def figures(client: TestClient) -> dict[tuple[str, ...], float]:
    answer = client.get("/v1/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    families = text_string_to_metric_families(answer.text)
    return {(one.name, *one.labels.values()): one.value for family in families for one in family.samples}


def test_figures_are_those_of_the_service(client: TestClient) -> None:
    for _ in range(3):
        client.get("/v1/plants")
    client.get("/v1/plants/unknown")
    client.get("/nowhere")
    found = figures(client)
    assert found["lpv_oed_requests_total", "GET", "/v1/plants", "200"] == 3
    assert found["lpv_oed_requests_total", "GET", "/v1/plants/{plantId}", "404"] == 1
    assert found["lpv_oed_requests_total", "GET", "none", "404"] == 1
    assert found["lpv_oed_request_seconds_count", "GET", "/v1/plants"] == 3
    assert found["lpv_oed_jobs", "queued"] == 0
    assert found["lpv_oed_ready",] == 1
    assert found["lpv_oed_free_bytes",] > 0


def test_what_cannot_be_looked_up_is_left_out(
    client: TestClient, container: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    def away() -> None:
        raise OperationalError("", None, Exception("away"))

    monkeypatch.setattr(container.database, "read", away)
    found = figures(client)
    assert ("lpv_oed_jobs", "queued") not in found
    assert found["lpv_oed_free_bytes",] > 0


def test_no_text_begins_a_line_of_the_log() -> None:
    record = logging.LogRecord("a", logging.INFO, "", 0, "first\nINFO: forged", None, None)
    with about(jobId="1"):
        AboutFilter().filter(record)
    assert TextFormatter().format(record).splitlines() == ["INFO:     first", "    INFO: forged [jobId=1]"]


def test_the_format_is_a_setting() -> None:
    assert Settings(log_format="json").log_format == "json"
