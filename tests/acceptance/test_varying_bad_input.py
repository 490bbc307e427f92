"""Bad input for models from varying scheduling over HTTP: each gets a clear problem at the right field."""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from app.files import csv_writer
from benchmarks.wind_turbine_plant import PLANT
from tests.support import paper, varying
from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.varying import Signals

LIKELIHOOD: Json = {"kind": "periodic_likelihood"}
MOESP: Json = {"kind": "periodic_moesp"}
COX: Json = {"kind": "correlation_realisation"}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", varying.TURBINE)


@pytest.fixture(scope="module")
def good(api: Api, plant: Json) -> str:
    return str(api.made("/experiments", varying.body(plant, varying.turbine(31)))["id"])


def slipping() -> Signals:
    """The input repeats itself after 120 samples, the scheduling after 10.1."""
    u, _, _ = varying.turbine(32)
    p = np.cos(2 * np.pi * np.arange(len(u)) / 10.1)[:, None]
    return varying.measured(PLANT, u, p, varying.NOISE, np.random.default_rng(1))


def one_sine() -> Signals:
    t = np.arange(2400)
    u = np.sin(2 * np.pi * t / 120)[:, None]
    return varying.measured(PLANT, u, np.cos(2 * np.pi * t / 10)[:, None], varying.NOISE, np.random.default_rng(2))


def still() -> Signals:
    u, _, p = varying.turbine(33)
    return varying.measured(PLANT, u, 0 * p + 0.2, varying.NOISE, np.random.default_rng(3))


def first(signals: Signals, samples: int) -> Signals:
    u, y, p = (signal[:samples] for signal in signals)
    return u, y, p


Case = tuple[Callable[[], Signals], Json, Json, str, str]
JOBS: dict[str, Case] = {
    "nothing repeats itself": (lambda: varying.white(PLANT, 1000), {}, LIKELIHOOD, "/experimentId", "does not repeat"),
    "scheduling is not periodic": (lambda: varying.white(PLANT, 1000), {}, MOESP, "/experimentId", "does not repeat"),
    "not synchronised": (slipping, {}, LIKELIHOOD, "/experimentId", "not synchronised"),
    "stated period of the input only": (
        slipping,
        {"periodSamples": 120},
        LIKELIHOOD,
        "/experimentId",
        "differ by up to",
    ),
    "one period and a half": (
        lambda: first(varying.turbine(), 180),
        {"periodSamples": 120},
        LIKELIHOOD,
        "/experimentId",
        "1.5 periods",
    ),
    "too few periods for the noise": (
        lambda: first(varying.turbine(period=20, periods=3), 60),
        {},
        LIKELIHOOD,
        "/experimentId",
        "record more periods",
    ),
    "all periods dropped": (
        lambda: varying.turbine(),
        {},
        {**LIKELIHOOD, "dropPeriods": 24},
        "/estimator/dropPeriods",
        "drop fewer",
    ),
    "window at the order": (lambda: varying.turbine(), {}, {**MOESP, "window": 2}, "/estimator/window", "10 ≥ d > 2"),
    "window above the period": (
        lambda: varying.turbine(),
        {},
        {**MOESP, "window": 11},
        "/estimator/window",
        "10 ≥ d > 2",
    ),
    "rank deficient, likelihood": (one_sine, {}, LIKELIHOOD, "/experimentId", "excite more"),
    "rank deficient, subspaces": (one_sine, {}, MOESP, "/experimentId", "excite"),
    "scheduling that is still": (still, {}, COX, "/experimentId", "scheduling"),
    "too short for words": (
        lambda: varying.white(PLANT, 50),
        {},
        {**COX, "parameters": "least_squares"},
        "/experimentId",
        "too few",
    ),
    "words beyond all bounds": (
        lambda: varying.turbine(),
        {},
        {**COX, "wordLength": 30},
        "/estimator/wordLength",
        "shorter words",
    ),
}


@pytest.mark.parametrize("name", JOBS)
def test_records_that_an_estimator_cannot_use(api: Api, plant: Json, name: str) -> None:
    signals, stated, estimator, pointer, reason = JOBS[name]
    record = api.made("/experiments", varying.body(plant, signals(), **stated))
    with pytest.raises(JobFailedError) as failure:
        api.made("/models/varying", {"plantId": plant["id"], "experimentId": record["id"], "estimator": estimator})
    problem = failure.value.problem
    assert (problem["status"], pointers(problem)) == (422, [pointer]), problem["detail"]
    assert reason in problem["detail"]


def test_how_far_off_synchronisation_is_stands_in_the_experiment(api: Api, plant: Json) -> None:
    record = api.made("/experiments", varying.body(plant, slipping(), periodSamples=120))["understood"]
    assert not record["varying"]["synchronised"]
    assert record["varying"]["schedulingDeviation"] > 0.5
    assert record["varying"]["inputDeviation"] < 1e-6
    assert "1.18812 of these" in record["varying"]["reason"] or "differ by up to" in record["varying"]["reason"]
    assert any("Methods that need no period" in warning for warning in record["warnings"])


REQUESTS: dict[str, tuple[Json, str]] = {
    "an unknown experiment": ({"experimentId": "none"}, "/experimentId"),
    "an unknown plant": ({"plantId": "none"}, "/plantId"),
    "held out twice": ({"heldOutExperimentIds": ["none", "none"]}, "/heldOutExperimentIds"),
    "an unknown estimator": ({"estimator": {"kind": "crystal_ball"}}, "/estimator"),
    "a start without a model": ({"estimator": {"kind": "output_error"}}, "/estimator"),
    "no regularisation": ({"estimator": {**MOESP, "regularisations": []}}, "/estimator"),
    "a negative drop": ({"estimator": {**LIKELIHOOD, "dropPeriods": -1}}, "/estimator"),
    "another sample time": ({"structure": {**varying.TURBINE["structure"], "sampleTimeSeconds": 2.0}}, "/experimentId"),
    "continuous time": ({"structure": {"timeDomain": "continuousStateSpace", "order": 2}}, "/structure"),
    "too many states": ({"structure": {**varying.TURBINE["structure"], "order": 30}}, "/structure"),
    "an unknown field": ({"experimentIds": ["none"]}, "/experimentIds"),
}


@pytest.mark.parametrize("name", REQUESTS)
def test_requests_that_do_not_fit(api: Api, plant: Json, good: str, name: str) -> None:
    change, pointer = REQUESTS[name]
    request = {"plantId": plant["id"], "experimentId": good, "estimator": LIKELIHOOD, **change}
    problem = api.refused("/models/varying", request)
    assert problem["status"] == 422
    assert all(found.startswith(pointer) for found in pointers(problem)), pointers(problem)


def test_an_order_is_needed(api: Api, plant: Json, good: str) -> None:
    structure = {**varying.TURBINE["structure"], "order": None}
    request = {"plantId": plant["id"], "experimentId": good, "estimator": LIKELIHOOD, "structure": structure}
    with pytest.raises(JobFailedError) as failure:
        api.made("/models/varying", request)
    assert pointers(failure.value.problem) == ["/structure"]


def test_experiments_of_the_other_sort_are_refused(api: Api, plant: Json, good: str) -> None:
    local = api.made("/experiments", {**varying.still(0.3, 1), "plantId": plant["id"]})["id"]
    request = {"plantId": plant["id"], "experimentId": local, "estimator": LIKELIHOOD}
    problem = api.refused("/models/varying", request)
    assert pointers(problem) == ["/experimentId"]
    assert "held still" in problem["detail"]
    problem = api.refused("/models/varying", {**request, "experimentId": good, "heldOutExperimentIds": [local]})
    assert pointers(problem) == ["/heldOutExperimentIds/0"]
    problem = api.refused("/models/varying", {**request, "experimentId": good, "heldOutExperimentIds": [good]})
    assert pointers(problem) == ["/heldOutExperimentIds"]
    state_space = {
        "plantId": plant["id"],
        "experimentIds": [good],
        "parametricEstimator": {"kind": "parametric_subspace"},
    }
    assert pointers(api.refused("/models/state-space", state_space)) == ["/experimentIds/0"]


def test_a_rational_plant_needs_a_structure_of_its_own(api: Api) -> None:
    plant = api.post("/plants", paper.PLANT)
    u, y, p = varying.turbine(34)
    record = api.made("/experiments", varying.body(plant, (u, y, 4 + 3 * p)))["id"]
    request = {"plantId": plant["id"], "experimentId": record, "estimator": LIKELIHOOD}
    assert pointers(api.refused("/models/varying", request)) == ["/structure"]
    found = api.made("/models/varying", {**request, "structure": varying.TURBINE["structure"]})
    assert found["structure"]["order"] == 2
    assert found["varying"]["fits"][0]["vafPercent"] > 98


def changed(**values: Any) -> Callable[[Json], Json]:
    return lambda body: {**body, **{name: value(body) if callable(value) else value for name, value in values.items()}}


EXPERIMENTS: dict[str, tuple[Callable[[Json], Json], str, str]] = {
    "scheduling out of range": (
        changed(scheduling=lambda body: [[2.0, *body["scheduling"][0][1:]]]),
        "/scheduling",
        "declare the range",
    ),
    "a scheduling signal too many": (
        changed(scheduling=lambda body: body["scheduling"] * 2),
        "/scheduling",
        "2 signals",
    ),
    "two inputs": (changed(inputs=lambda body: body["inputs"] * 2), "/inputs", "the plant has 1"),
    "no outputs": (changed(outputs=[]), "/outputs", ""),
    "an output cut short": (changed(outputs=lambda body: [body["outputs"][0][:-1]]), "/outputs", "equal lengths"),
    "ragged": (changed(inputs=lambda body: [body["inputs"][0], body["inputs"][0][:-1]]), "/inputs", "differ in length"),
    "one sample": (changed(inputs=[[1.0]], outputs=[[1.0]], scheduling=[[0.0]]), "/inputs", "record longer"),
    "a period beyond the record": (changed(periodSamples=10_000), "/periodSamples", "between 2 and"),
    "an operating point": (changed(operatingPoint=[0.0]), "", ""),
    "no sample time": (changed(sampleTimeSeconds=0), "", ""),
}


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_bad_records(api: Api, plant: Json, name: str) -> None:
    change, pointer, reason = EXPERIMENTS[name]
    problem = api.refused("/experiments", change(varying.body(plant, first(varying.turbine(), 240))))
    assert problem["status"] == 422
    assert all(found.startswith(pointer) for found in pointers(problem)), pointers(problem)
    assert reason in problem["detail"]


FILES: dict[str, tuple[Callable[[Signals], dict[str, Any]], Json, str, str]] = {
    "no scheduling": (lambda s: {"u": s[0][:, 0], "y": s[1][:, 0]}, {}, "/file", "operatingPoint"),
    "out of range": (lambda s: {"u": s[0][:, 0], "y": s[1][:, 0], "p": 3 * s[2][:, 0]}, {}, "/file", "declared range"),
    "no such column": (
        lambda s: {"u": s[0][:, 0], "y": s[1][:, 0], "p": s[2][:, 0]},
        {"schedulingColumns": ["angle"]},
        "/file",
        "angle",
    ),
    "channels with a gap": (
        lambda s: {"u1": s[0][:, 0], "u3": s[0][:, 0], "y": s[1][:, 0], "p": s[2][:, 0]},
        {},
        "/file",
        "numbered",
    ),
    "an input too many": (
        lambda s: {"u1": s[0][:, 0], "u2": s[0][:, 0], "y": s[1][:, 0], "p": s[2][:, 0]},
        {},
        "/file",
        "the plant has 1",
    ),
    "an output of zeros": (lambda s: {"u": s[0][:, 0], "y": 0 * s[1][:, 0], "p": s[2][:, 0]}, {}, "/file", "zero"),
}


@pytest.mark.parametrize("name", FILES)
def test_bad_files(api: Api, plant: Json, name: str) -> None:
    columns, stated, pointer, reason = FILES[name]
    content = csv_writer.write(columns(first(varying.turbine(), 240)))
    with pytest.raises(JobFailedError) as failure:
        api.uploaded("a.csv", content, plantId=plant["id"], sampleTimeSeconds=1.0, **stated)
    problem = failure.value.problem
    assert (problem["status"], pointers(problem)) == (422, [pointer])
    assert reason in problem["detail"]


def test_scheduling_columns_and_an_operating_point_exclude_each_other(api: Api, plant: Json) -> None:
    columns = {"plantId": plant["id"], "schedulingColumns": ["a"]}
    for stated in ({**columns, "operatingPoint": [0.0]}, {**columns, "schedulingColumns": ["a", "b"]}):
        answer = api.http.post("/experiments/files", data=stated, files={"file": ("a.csv", b"u,y\n1,2\n")})
        assert pointers(api.problem(answer)) == ["/schedulingColumns"]


def test_a_running_job_says_how_far_it_is_and_can_be_cancelled(api: Api, plant: Json) -> None:
    record = api.made("/experiments", varying.body(plant, varying.white(PLANT, 20_000)))["id"]
    structure = {**varying.TURBINE["structure"], "order": 4}
    slow = {**COX, "refinement": False, "corrections": 0}
    request = {"plantId": plant["id"], "experimentId": record, "estimator": slow, "structure": structure}
    job = api.post("/models/varying", {**request, "refinement": {"kind": "output_error", "maxIterations": 1000}})
    while not (job["state"] == "running" and "likelihood" in (job["progress"]["message"] or "")):
        assert job["state"] in ("queued", "running")
        time.sleep(0.02)
        job = api.get(f"/jobs/{job['id']}")
    assert 0.5 <= job["progress"]["fraction"] < 1
    api.http.post(f"/jobs/{job['id']}/cancellation")
    with pytest.raises(JobFailedError, match="cancelled"):
        api.finished(job)
