"""Bad input through HTTP: each gets a clear problem at the right field, and the server goes on."""

import json
import socket
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.bad_files import BAD_FILES
from tests.support.paper import FIGURES, NOISE_VARIANCE, PLANT, THETA, only, played, prepared
from tests.support.patience import PATIENCE
from tests.support.server import running_server

RECORD: Json = {"kind": "timeRecord", "operatingPoint": [1.0], "sampleTimeSeconds": 1.0}
RESPONSE: Json = {
    "kind": "frequencyResponse",
    "operatingPoint": [1.0],
    "frequenciesRadPerSecond": [0.1, 0.2],
    "response": {"re": [1.0, 2.0], "im": [0.0, 0.0]},
}
WAVE = np.random.default_rng(0).normal(size=80).tolist()


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """A server with a small limit on bodies."""
    limits = {"LPV_OED_MAX_BODY_BYTES": "2000000"}
    with running_server(tmp_path_factory.mktemp("bad") / "data", limits) as server:
        yield Api(server.url)
        assert server.healthy()
        assert "Traceback" not in server.log_text()


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


@pytest.fixture(scope="module")
def stated(api: Api, plant: Json) -> Json:
    return api.post("/models/stated", {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE})


def changed(document: Json, path: str, value: Any) -> Json:
    """A copy with one value replaced, at a path such as structure/na."""
    copy = json.loads(json.dumps(document))
    *steps, last = path.split("/")
    inner = copy
    for step in steps:
        inner = inner[int(step)] if isinstance(inner, list) else inner[step]
    inner[int(last) if isinstance(inner, list) else last] = value
    return copy


PLANTS = {
    "unknown field": ("colour", "red", "/colour"),
    "unknown field inside": ("structure/order", 1, "/structure/order"),
    "no such time domain": ("structure/timeDomain", "sampled", "/structure"),
    "order below zero": ("structure/na", -1, "/structure/na"),
    "order as text": ("structure/na", "1", "/structure/na"),
    "fraction of an order": ("structure/na", 1.5, "/structure/na"),
    "sample time zero": ("structure/sampleTimeSeconds", 0, "/structure/sampleTimeSeconds"),
    "boolean for a number": ("structure/sampleTimeSeconds", True, "/structure/sampleTimeSeconds"),
    "empty range": ("schedulingVariables/0/maximum", 0.0, "/schedulingVariables"),
    "no scheduling variable": ("schedulingVariables", [], "/schedulingVariables"),
    "no such basis": ("basis/factors/0/kind", "fourier", "/basis/factors/0"),
    "degree below zero": ("basis/factors/0/degree", -1, "/basis/factors/0"),
    "huge degree": ("basis/factors/0/degree", 10**9, "/basis"),
    "two factors for one variable": ("basis/factors", [{"kind": "polynomial", "degree": 1}] * 2, "/basis"),
    "no such coefficient": (
        "coefficientBases",
        [{"coefficient": "z9", "basis": PLANT["basis"]}],
        "/coefficientBases",
    ),
    "knot outside": ("basis/factors/0", {"kind": "b_spline", "degree": 1, "interiorKnots": [99.0]}, "/basis"),
}


@pytest.mark.parametrize("name", PLANTS)
def test_bad_plants(api: Api, name: str) -> None:
    path, value, pointer = PLANTS[name]
    problem = api.refused("/plants", changed({**PLANT, "coefficientBases": []}, path, value))
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]
    assert problem["errors"][0]["detail"]


EXPERIMENTS = {
    "different lengths": ({**RECORD, "input": [1.0, 2.0, 3.0], "output": [1.0, 2.0]}, "/output"),
    "one sample": ({**RECORD, "input": [1.0], "output": [1.0]}, "/input"),
    "no samples": ({**RECORD, "input": [], "output": []}, "/input"),
    "not numbers": ({**RECORD, "input": [1.0, "a"], "output": [1.0, 2.0]}, "/input/1"),
    "nested": ({**RECORD, "input": [1.0, [2.0]], "output": [1.0, 2.0]}, "/input/1"),
    "point of two values": ({**RECORD, "operatingPoint": [1.0, 2.0], "input": WAVE, "output": WAVE}, "/operatingPoint"),
    "point outside": ({**RECORD, "operatingPoint": [9.0], "input": WAVE, "output": WAVE}, "/operatingPoint"),
    "period too long": ({**RECORD, "periodSamples": 900, "input": WAVE, "output": WAVE}, "/periodSamples"),
    "unknown kind": ({**RECORD, "kind": "movie"}, ""),
    "negative frequency": ({**RESPONSE, "frequenciesRadPerSecond": [-1.0, 2.0]}, "/frequenciesRadPerSecond"),
    "frequency twice": ({**RESPONSE, "frequenciesRadPerSecond": [2.0, 2.0]}, "/frequenciesRadPerSecond"),
    "too few values": ({**RESPONSE, "response": {"re": [1.0], "im": [0.0]}}, "/response"),
    "re and im differ": ({**RESPONSE, "response": {"re": [1.0], "im": []}}, "/response"),
    "variance of zero": ({**RESPONSE, "variance": [1.0, 0.0]}, "/variance"),
    "beyond Nyquist": ({**RESPONSE, "sampleTimeSeconds": 100.0}, "/frequenciesRadPerSecond"),
    "unknown design": ({**RECORD, "designId": "0" * 32, "input": WAVE, "output": WAVE}, "/designId"),
}


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_bad_experiments(api: Api, plant: Json, name: str) -> None:
    body, pointer = EXPERIMENTS[name]
    problem = api.refused("/experiments", {"plantId": plant["id"], **body})
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]


@pytest.mark.parametrize("text", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_what_is_not_a_finite_number_is_refused(api: Api, plant: Json, text: str) -> None:
    body = json.dumps({"plantId": plant["id"], **RECORD, "input": [1.0, "@"], "output": [1.0, 2.0]})
    answer = api.http.post(
        "/experiments", content=body.replace('"@"', text), headers={"Content-Type": "application/json"}
    )
    problem = api.problem(answer)
    assert problem["status"] == 422
    assert pointers(problem) == ["/input/1"]


def test_a_record_of_zeros_fails_with_what_is_wrong(api: Api, plant: Json) -> None:
    with pytest.raises(JobFailedError) as failure:
        api.made("/experiments", {"plantId": plant["id"], **RECORD, "input": [0.0] * 80, "output": [0.0] * 80})
    assert failure.value.problem["status"] == 422
    assert "zero" in failure.value.problem["detail"]


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_files(api: Api, plant: Json, name: str) -> None:
    file_name, content = BAD_FILES[name]
    with pytest.raises(JobFailedError) as failure:
        api.uploaded(file_name, content, plantId=plant["id"], operatingPoint=[1.0])
    problem = failure.value.problem
    assert problem["status"] == 422, problem
    assert problem["detail"]
    assert api.get("/health")["status"] == "ok"


@pytest.mark.parametrize(
    ("fields", "pointer"),
    [
        ({"periodSample": "4"}, "/periodSample"),
        ({"sampletimeseconds": "1"}, "/sampletimeseconds"),
        ({"periodSamples": ["4", "5"]}, "/periodSamples"),
        ({"plantId": ["0" * 32, "1" * 32]}, "/plantId"),
    ],
)
def test_unknown_and_repeated_fields_of_uploads_are_refused(
    api: Api, plant: Json, fields: dict[str, Any], pointer: str
) -> None:
    given = {"plantId": plant["id"], "operatingPoint": ["1.0"], **fields}
    content = b"time,input,output\n0,1,2\n1,2,1\n2,1,1\n"
    problem = api.problem(api.http.post("/experiments/files", data=given, files={"file": ("a.csv", content)}))
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]


@pytest.mark.parametrize("size", [2_000_001, 30_000_000])
def test_a_body_over_the_limit_is_answered_before_the_connection_closes(api: Api, size: int) -> None:
    address = urlsplit(api.url)
    with socket.create_connection((address.hostname, address.port), timeout=PATIENCE) as connection:
        head = f"POST /v1/plants HTTP/1.1\r\nHost: {address.netloc}\r\nContent-Length: {size}\r\n"
        connection.sendall(head.encode() + b"Content-Type: application/json\r\n\r\n")
        connection.sendall(b" " * size)
        answer = connection.makefile("rb").readline()
    assert answer.startswith(b"HTTP/1.1 413 ")


def test_files_of_no_known_kind_and_empty_files_are_refused_at_once(api: Api, plant: Json) -> None:
    fields = {"plantId": plant["id"], "operatingPoint": ["1.0"]}
    for name, content in (("data.pdf", b"x"), ("data.csv", b"")):
        problem = api.problem(api.http.post("/experiments/files", data=fields, files={"file": (name, content)}))
        assert pointers(problem) == ["/file"]


def test_a_body_over_the_limit_is_refused(api: Api, plant: Json) -> None:
    body = {"plantId": plant["id"], **RECORD, "input": [1.5] * 500_000, "output": [1.5] * 500_000}
    assert api.refused("/experiments", body)["status"] == 413
    files = {"file": ("a.csv", b"time,input,output\n" + b"1,2,3\n" * 500_000)}
    fields = {"plantId": plant["id"], "operatingPoint": ["1.0"]}
    assert api.problem(api.http.post("/experiments/files", data=fields, files=files))["status"] == 413


def test_bodies_that_are_no_json(api: Api) -> None:
    headers = {"Content-Type": "application/json"}
    for content in (b"{", b"\xff\xfe", b"[" * 100_000, b""):
        assert api.problem(api.http.post("/plants", content=content, headers=headers))["status"] in (400, 422)


STATED = {
    "too few parameters": ({"theta": [1.0]}, "/theta"),
    "unstable": ({"theta": [-1.5, 0.0, 10.0, 0.0, -0.7, 0.0]}, "/theta"),
    "unstable at one end": ({"theta": [-0.9, -0.1, 10.0, -1.0, -0.7, 0.08]}, "/theta"),
    "noise model unstable": ({"theta": [-0.9, 0.1, 10.0, -1.0, -1.7, 0.08]}, "/theta"),
    "coefficients too large for a number": ({"theta": [-0.9, 0.1, 1.7e308, 1.7e308, -0.7, 0.08]}, "/theta"),
    "negative variance": ({"noiseVariance": -1.0}, "/noiseVariance"),
    "no noise at all": ({"noiseVariance": 0.0}, "/noiseVariance"),
    "parameters beyond all numbers": ({"theta": [1e308] * 6}, "/theta"),
    "covariance of another size": ({"covariance": [[1.0]]}, "/covariance"),
    "ragged covariance": ({"covariance": [[1.0], [1.0, 2.0]]}, "/covariance"),
    "covariance not positive": ({"covariance": np.diag([-1.0] * 6).tolist()}, "/covariance"),
    "covariance not symmetric": ({"covariance": np.triu(np.ones((6, 6))).tolist()}, "/covariance"),
    "unknown plant": ({"plantId": "nothing"}, "/plantId"),
}


@pytest.mark.parametrize("name", STATED)
def test_bad_stated_models(api: Api, plant: Json, name: str) -> None:
    change, pointer = STATED[name]
    body = {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE, **change}
    problem = api.refused("/models/stated", body)
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]


DESIGNS = {
    "no operating point": ("operatingPoints/points", [], "/operatingPoints/points"),
    "point of two values": ("operatingPoints/points/0", [0.0, 1.0], "/operatingPoints"),
    "point outside": ("operatingPoints/points/0", [80.0], "/operatingPoints"),
    "grid too large": (
        "operatingPoints",
        {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 8.0, "count": 10**9}]},
        "/operatingPoints/axes/0/count",
    ),
    "box of two variables": (
        "operatingPoints",
        {"kind": "box", "minimum": [0.0, 0.0], "maximum": [8.0, 8.0]},
        "/operatingPoints",
    ),
    "everything excluded": ("excludedPoints", [[0.0], [1.5], [8.0]], "/excludedPoints"),
    "no targets": ("targets", [], "/targets"),
    "no such target": ("targets/0/kind", "beauty", "/targets/0"),
    "no such family": ("spectrumFamily/kind", "chirp", "/spectrumFamily"),
    "degree below zero": ("spectrumFamily/degree", -3, "/spectrumFamily"),
    "no samples": ("samples", 0, "/samples"),
    "cap of nothing": ("energyCaps", {"default": 0.0}, "/energyCaps/default"),
    "cap elsewhere": ("energyCaps", {"perPoint": [{"operatingPoint": [3.0], "energy": 1.0}]}, "/energyCaps"),
    "prior without covariance": ("usePriorInformation", True, "/usePriorInformation"),
    "band upside down": ("band", {"minimumRadPerSecond": 2.0, "maximumRadPerSecond": 1.0}, "/band"),
    "unknown model": ("modelId", "0" * 32, "/modelId"),
}


@pytest.mark.parametrize("name", DESIGNS)
def test_bad_designs(api: Api, plant: Json, stated: Json, name: str) -> None:
    path, value, pointer = DESIGNS[name]
    body = {**FIGURES[0].body(plant, stated), "operatingPoints": only(0.0, 1.5, 8.0)}
    problem = api.refused("/designs", changed(body, path, value))
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]


FAILING_DESIGNS = {
    "deviations for other parameters": ("targets/0/standardDeviations", [0.1], "/targets/0/standardDeviations"),
    "deviation of zero": ("targets/0/standardDeviations", [0.0] * 6, "/targets/0/standardDeviations"),
    "band for an FIR spectrum": ("band", {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 1.0}, "/band"),
}


@pytest.mark.parametrize("name", FAILING_DESIGNS)
def test_designs_that_cannot_be_stated(api: Api, plant: Json, stated: Json, name: str) -> None:
    path, value, pointer = FAILING_DESIGNS[name]
    with pytest.raises(JobFailedError) as failure:
        api.made("/designs", changed(FIGURES[0].body(plant, stated), path, value))
    assert failure.value.problem["status"] == 422
    assert pointers(failure.value.problem) == [pointer]


def test_targets_out_of_reach_say_what_to_change(api: Api, plant: Json, stated: Json) -> None:
    body = {**FIGURES[0].body(plant, stated), "energyCaps": {"default": 10.0}}
    design = api.made("/designs", body)
    assert design["outcome"]["status"] == "infeasible"
    assert "caps" in design["outcome"]["advice"]
    assert "totalEnergy" not in design
    assert design["experiments"] == []
    problem = api.refused(f"/designs/{design['id']}/signals", {})
    assert "no experiments" in problem["detail"]


def test_one_operating_point_cannot_determine_a_slope(api: Api, plant: Json, stated: Json) -> None:
    design = api.made("/designs", {**FIGURES[0].body(plant, stated), "operatingPoints": only(2.0)})
    assert design["outcome"]["status"] == "infeasible"
    assert design["outcome"]["advice"]


@pytest.fixture(scope="module")
def measured(api: Api, plant: Json) -> list[str]:
    generator, made = np.random.default_rng(1), []
    for point in (0.0, 0.0, 8.0):
        u = generator.normal(size=300)
        body = {"input": u.tolist(), "output": played(point, u, generator).tolist(), "operatingPoint": [point]}
        made.append(api.made("/experiments", {**RECORD, "plantId": plant["id"], **body})["id"])
    return made


def fit(plant: Json, experiments: list[str], **change: Any) -> Json:
    return {
        "plantId": plant["id"],
        "experimentIds": experiments,
        "localEstimator": {"kind": "prediction_error"},
        "lpvEstimator": {"kind": "generalised_least_squares"},
        **change,
    }


def test_too_few_operating_points(api: Api, plant: Json, measured: list[str]) -> None:
    problem = api.refused("/models", fit(plant, measured[:2]))
    assert pointers(problem) == ["/experimentIds"]
    assert "at least 2" in problem["detail"]


def test_data_and_estimators_that_do_not_fit(api: Api, plant: Json, measured: list[str]) -> None:
    continuous = {"timeDomain": "continuous", "na": 1, "nb": 0}
    other = {**PLANT["structure"], "sampleTimeSeconds": 0.5}
    rational = {"kind": "rational_fit", "weighting": "relative"}
    response = api.made("/experiments", {"plantId": plant["id"], **RESPONSE, "sampleTimeSeconds": 1.0})["id"]
    plain = {**PLANT["structure"], "nd": 0}
    cases = {
        "/experimentIds/0": fit(plant, measured, structure=other),
        "/localEstimator": fit(plant, measured, structure=continuous),
        "/spectralEstimator": fit(plant, measured, structure=plain, localEstimator=rational),
        "/structure": fit(plant, measured, localEstimator=rational),
        "/experimentIds/3": fit(plant, [*measured, response]),
        "/experimentIds": fit(plant, [measured[0], measured[0]]),
        "/experimentIds/1": fit(plant, [measured[0], "0" * 32]),
        "/priorModelId": fit(plant, measured, priorModelId="0" * 32),
        "/localEstimator/initialConditions": fit(
            plant, measured, localEstimator={"kind": "prediction_error", "initialConditions": "warm"}
        ),
    }
    assert {pointer: pointers(api.refused("/models", body)) for pointer, body in cases.items()} == {
        pointer: [pointer] for pointer in cases
    }


def test_mixed_sample_times(api: Api, plant: Json, measured: list[str]) -> None:
    slow = {**RECORD, "sampleTimeSeconds": 2.0, "plantId": plant["id"], "operatingPoint": [4.0]}
    other = api.made("/experiments", {**slow, "input": WAVE, "output": WAVE[::-1]})["id"]
    problem = api.refused("/models", fit(plant, [*measured, other]))
    assert pointers(problem) == ["/experimentIds/3"]
    assert "2 s" in problem["detail"]


def test_experiments_of_another_plant_are_refused(api: Api, measured: list[str]) -> None:
    other, _ = prepared(api)
    assert pointers(api.refused("/models", fit(other, measured))) == ["/experimentIds/0"]


def test_a_structure_that_the_data_cannot_determine(api: Api, plant: Json) -> None:
    """A first-order plant without noise identified with order two: a pole and a zero cancel anywhere."""
    generator, made = np.random.default_rng(3), []
    for point in (0.0, 8.0):
        u = generator.normal(size=300)
        body = {"input": u.tolist(), "output": played(point, u, None).tolist(), "operatingPoint": [point]}
        made.append(api.made("/experiments", {**RECORD, "plantId": plant["id"], **body})["id"])
    large = {**PLANT["structure"], "na": 2, "nb": 1, "nd": 0}
    with pytest.raises(JobFailedError) as failure:
        api.made("/models", fit(plant, made, structure=large))
    assert failure.value.problem["status"] == 422
    assert "determine" in failure.value.problem["detail"]


def test_an_input_that_excites_too_little(api: Api, plant: Json) -> None:
    generator, made = np.random.default_rng(2), []
    for point in (0.0, 8.0):
        u = np.ones(200)
        body = {"input": u.tolist(), "output": played(point, u, generator).tolist(), "operatingPoint": [point]}
        made.append(api.made("/experiments", {**RECORD, "plantId": plant["id"], **body}))
    assert any("constant" in warning for warning in made[0]["understood"]["warnings"])
    two_gains = {**PLANT["structure"], "nb": 2}
    with pytest.raises(JobFailedError) as failure:
        api.made("/models", fit(plant, [one["id"] for one in made], structure=two_gains))
    assert failure.value.problem["status"] == 422


def test_unknown_resources(api: Api) -> None:
    missing = "0" * 32
    for path in ("plants", "experiments", "models", "designs", "signals", "jobs"):
        for identifier in (missing, "x", "%00", "é"):
            assert api.problem(api.http.get(f"/{path}/{identifier}"))["status"] == 404
    assert api.problem(api.http.get(f"/signals/{missing}/file"))["status"] == 404
    assert api.refused(f"/designs/{missing}/signals", {})["status"] == 404


def test_bad_queries(api: Api, stated: Json) -> None:
    path = f"/models/{stated['id']}/frequency-response"
    good = {"operatingPoint": 1.0, "minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0}
    cases = {
        "operatingPoint": 99.0,
        "minimumRadPerSecond": "nan",
        "maximumRadPerSecond": 4.0,
        "count": 10**6,
    }
    for name, value in cases.items():
        problem = api.problem(api.http.get(path, params={**good, name: value}))
        assert problem["status"] == 422
        assert pointers(problem) == [f"/{name}"]
    assert api.problem(api.http.get("/models", params={"cursor": "../.."}))["status"] == 422


def test_signals_that_cannot_be_made(api: Api, plant: Json, stated: Json) -> None:
    design = api.made(
        "/designs", {**FIGURES[0].body(plant, stated), "spectrumFamily": {"kind": "lines", "samples": 200}}
    )
    path = f"/designs/{design['id']}/signals"
    assert pointers(api.refused(path, {"method": "filtered_noise"})) == ["/method"]
    assert pointers(api.refused(path, {"samples": 10_000_000, "periods": 10})) == ["/samples"]
    assert pointers(api.refused(path, {"amplitudeLimit": -1.0})) == ["/amplitudeLimit"]
    with pytest.raises(JobFailedError) as failure:
        api.made(path, {"samples": 77})
    assert pointers(failure.value.problem) == ["/samples"]
    made = api.made(path, {})
    assert pointers(api.problem(api.http.get(f"/signals/{made['id']}/file", params={"index": 99}))) == ["/index"]
