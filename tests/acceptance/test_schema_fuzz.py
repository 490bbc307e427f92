"""Whatever is sent to the service, the answer is one that the OpenAPI document promises, and never a server error.

Each generated request is sent as it is and again with identifiers of what is there, which reaches behind "not found".
"""

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import requests
import schemathesis
from hypothesis import HealthCheck, settings
from schemathesis.checks import CheckFunction
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.support import responses
from tests.support.api import Api, Json
from tests.support.client import OPENAPI
from tests.support.paper import FIGURES, THETA, prepared
from tests.support.patience import PATIENCE
from tests.support.server import Server, running_server

CHECKS: list[CheckFunction] = [
    schemathesis.checks.not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]
TIME_LIMIT = {"LPV_OED_JOB_TIME_LIMIT_SECONDS": "60"}
SECONDS_FOR_JOBS = 8.0
EXPECTED = ("Invalid request", "Time limit reached", "Memory limit reached")
schema = schemathesis.openapi.from_path(str(OPENAPI))


@pytest.fixture(scope="module")
def fuzzed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server of its own, whose jobs may be of any size."""
    with running_server(tmp_path_factory.mktemp("fuzz") / "data", TIME_LIMIT) as running:
        yield running


@pytest.fixture(scope="module")
def session() -> Iterator[requests.Session]:
    with requests.Session() as opened:
        yield opened


@pytest.fixture(scope="module")
def known(fuzzed: Server) -> dict[str, str]:
    """One identifier of each kind, by the name of the path parameter."""
    api = Api(fuzzed.url)
    plant, model = prepared(api)
    job = api.finished(api.post("/designs", FIGURES[0].body(plant, model)))
    design = job["result"]["id"]
    signals = api.made(f"/designs/{design}/signals", {"method": "filtered_noise"})
    signal = [float(t % 7 - 3) for t in range(50)]
    record = {"kind": "timeRecord", "sampleTimeSeconds": 1.0, "input": signal, "output": signal[::-1]}
    experiment = api.made("/experiments", {**record, "plantId": plant["id"], "operatingPoint": [1.0]})
    compared = {"modelId": model["id"], "experimentIds": [experiment["id"]]}
    diagnosis = api.made("/diagnoses", compared)
    covariance = (np.eye(len(THETA)) * 1e-6).tolist()
    stated = {"plantId": plant["id"], "theta": THETA, "noiseVariance": 0.5, "covariance": covariance}
    comparison = api.made("/comparisons", {**compared, "modelId": api.post("/models/stated", stated)["id"]})
    example = api.made("/examples", {"hiddenEffect": "none"})
    report = api.made(f"/models/{model['id']}/reports", {})
    asked = {"experimentIds": compared["experimentIds"], "effects": ["delay"]}
    staircase = api.made(f"/models/{model['id']}/staircases", asked)
    made = {"plantId": plant, "modelId": model, "experimentId": experiment, "signalsId": signals}
    made |= {"comparisonId": comparison, "diagnosisId": diagnosis}
    made |= {"exampleId": example, "reportId": report, "staircaseId": staircase}
    return {name: document["id"] for name, document in made.items()} | {"designId": design, "jobId": job["id"]}


@pytest.fixture(scope="module")
def in_state_space(fuzzed: Server) -> dict[str, str]:
    """A plant with two inputs and outputs, and an experiment of it."""
    api = Api(fuzzed.url)
    plant = api.post("/plants", responses.PLANT)
    experiment = api.made("/experiments", responses.body(plant, responses.measured(0.7)))
    return {"plantId": plant["id"], "experimentId": experiment["id"]}


def with_known(values: Any, known: dict[str, str]) -> Any:
    """The same fields, with known identifiers where there is one of that name."""
    if not isinstance(values, dict):
        return values
    found = {name: known[name] for name in values if name in known}
    if "experimentIds" in values:
        found["experimentIds"] = [known["experimentId"]]
    if "effect" in values:
        found["effect"] = "delay"
    return {**values, **found}


def checks(case: schemathesis.Case) -> list[CheckFunction]:
    """All checks; the schema of an event stream is that of the whole stream, not of each event."""
    is_stream = case.path.endswith("/events")
    return [check for check in CHECKS if not (is_stream and check is response_schema_conformance)]


@schema.parametrize()
@settings(max_examples=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
def test_answers_are_as_promised(
    case: schemathesis.Case,
    fuzzed: Server,
    session: requests.Session,
    known: dict[str, str],
    in_state_space: dict[str, str],
) -> None:
    asked = {"base_url": fuzzed.url, "session": session, "checks": checks(case), "timeout": PATIENCE}
    case.call_and_validate(**asked)
    sent = (case.path_parameters, case.body)
    if case.path.endswith("/state-space"):
        known = known | in_state_space
    case.path_parameters, case.body = (with_known(values, known) for values in sent)
    if (case.path_parameters, case.body) != sent:
        case.call_and_validate(**asked)


def test_no_job_that_was_started_ends_in_a_fault(fuzzed: Server, known: dict[str, str]) -> None:
    api = Api(fuzzed.url)
    end = time.monotonic() + SECONDS_FOR_JOBS
    while (waiting := unfinished(api)) and time.monotonic() < end:
        time.sleep(0.2)
    for job in waiting:
        api.post(f"/jobs/{job['id']}/cancellation", {})
    problems = [job["problem"] for job in api.get("/jobs", state="failed", limit=500)["items"]]
    assert [problem for problem in problems if problem["title"] not in EXPECTED] == []


def unfinished(api: Api) -> list[Json]:
    return [job for state in ("running", "queued") for job in api.get("/jobs", state=state, limit=500)["items"]]
