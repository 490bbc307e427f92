"""Bad input for state-space models through HTTP: each gets a clear problem at the right field."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.support import paper, responses
from tests.support.api import Api, JobFailedError, Json, pointers

PARAMETRIC: Json = {"kind": "parametric_subspace"}
SUBSPACE: Json = {"kind": "frequency_subspace"}
DISC: Json = {"kind": "disc", "radius": 0.95}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", responses.PLANT)


@pytest.fixture(scope="module")
def exact(api: Api, plant: Json) -> list[str]:
    data = [responses.measured(point) for point in responses.POINTS]
    return [api.made("/experiments", responses.body(plant, one))["id"] for one in data]


Change = Callable[[Json], Any]
EXPERIMENTS: dict[str, tuple[Change, str]] = {
    "repeated frequencies": (lambda b: set_at(b, "frequenciesRadPerSecond", [0.5] * 60), "/frequenciesRadPerSecond"),
    "fewer matrices than frequencies": (lambda b: (b["response"]["re"].pop(), b["response"]["im"].pop()), "/response"),
    "fewer imaginary parts": (lambda b: b["response"]["im"].pop(), "/response"),
    "rows of different length": (lambda b: b["response"]["re"][3][0].pop(), "/response"),
    "no rows": (lambda b: set_at(b, "response", {"re": [[]] * 60, "im": [[]] * 60}), "/response"),
    "no numbers": (lambda b: set_at(b, "response", {"re": 1.0, "im": 1.0}), None),
    "one output only": (lambda b: [matrix.pop() for part in b["response"].values() for matrix in part], "/response"),
    "variance of another shape": (lambda b: set_at(b, "variance", [[[1.0, 1.0]]] * 60), "/variance"),
    "variance with ragged rows": (lambda b: set_at(b, "variance", [[[1.0], [1.0, 1.0]]] * 60), "/variance"),
    "variance of zero": (lambda b: set_at(b, "variance", [[[0.0, 1.0], [1.0, 1.0]]] * 60), "/variance"),
    "beyond Nyquist": (lambda b: set_at(b, "sampleTimeSeconds", 2.0), "/frequenciesRadPerSecond"),
    "one channel for two": (
        lambda b: b.update(kind="frequencyResponse", response={"re": [1.0] * 60, "im": [0.0] * 60}),
        "/response",
    ),
    "a record": (
        lambda b: (
            [b.pop(name) for name in ("frequenciesRadPerSecond", "response", "variance")]
            and b.update(kind="timeRecord", input=[1.0, 2.0], output=[1.0, 2.0])
        ),
        "/output",
    ),
}


def set_at(document: Json, name: str, value: Any) -> None:
    document[name] = value


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_bad_responses(api: Api, plant: Json, name: str) -> None:
    change, pointer = EXPERIMENTS[name]
    request = json.loads(json.dumps(responses.body(plant, responses.measured(1.0))))
    change(request)
    problem = api.refused("/experiments", request)
    assert problem["status"] == 422
    assert pointers(problem) == ([pointer] if pointer else ["/response/re", "/response/im"])
    assert problem["errors"][0]["detail"]


def test_matrices_are_refused_by_a_plant_of_one_input_and_output(api: Api) -> None:
    plant = api.post("/plants", paper.PLANT)
    problem = api.refused("/experiments", responses.body(plant, responses.measured(1.0)))
    assert pointers(problem) == ["/response"]
    assert "2 outputs and 2 inputs, the plant has 1 and 1" in problem["detail"]


GOOD = responses.measured(1.0)
FILES: dict[str, tuple[str, bytes, str]] = {
    "another number of frequencies": ("a.npz", responses.npz(w=GOOD.frequencies[:-1], g=GOOD.response), "shape"),
    "four dimensions": ("a.npz", responses.npz(w=GOOD.frequencies, g=1j * np.ones((60, 2, 2, 2))), "shape"),
    "an output too many": ("a.npz", responses.npz(w=GOOD.frequencies, g=1j * np.ones((60, 3, 2))), "3 outputs"),
    "a table for four channels": ("a.npz", responses.npz(w=GOOD.frequencies, g=1j * np.ones((60, 4))), "shape"),
    "repeated frequencies": ("a.npz", responses.npz(w=np.ones(60), g=GOOD.response), "twice"),
    "an entry missing": ("a.csv", b"omega,re_y1_u1,re_y2_u2,im_y1_u1,im_y2_u2\n1,1,1,1,1\n", "output 1 and input 2"),
    "parts of other sizes": (
        "a.csv",
        b"omega,re_y1_u1,re_y1_u2,im_y1_u1\n1,1,1,1\n2,1,1,1\n",
        "imaginary",
    ),
    "variance of another shape": (
        "a.npz",
        responses.npz(w=GOOD.frequencies, g=GOOD.response, variance=np.ones(60)),
        "variance",
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_bad_files(api: Api, plant: Json, name: str) -> None:
    file_name, content, reason = FILES[name]
    with pytest.raises(JobFailedError) as failure:
        api.uploaded(file_name, content, plantId=plant["id"], operatingPoint=[1.0], sampleTimeSeconds=1.0)
    problem = failure.value.problem
    assert problem["status"] == 422
    assert reason in problem["detail"]
    assert problem["errors"], "it says which field"


EMPTY: Json = {"kind": "intersection", "regions": [{"kind": "disc"}, {"kind": "half_plane", "edge": -2.0}]}
NESTED: Json = {"kind": "intersection", "regions": [{"kind": "intersection", "regions": [DISC]}]}
REGION = "/parametricEstimator/region"
MODELS: dict[str, tuple[Json, str]] = {
    "nothing asked for": ({}, "/subspaceEstimator"),
    "q is not above n": ({"parametricEstimator": {**PARAMETRIC, "blockRows": 3}}, "/parametricEstimator/blockRows"),
    "q is not above n at a point": (
        {"subspaceEstimator": {**SUBSPACE, "blockRows": 3}},
        "/subspaceEstimator/blockRows",
    ),
    "an empty region": ({"parametricEstimator": {**PARAMETRIC, "region": EMPTY}}, REGION),
    "an intersection of nothing": (
        {"parametricEstimator": {**PARAMETRIC, "region": {"kind": "intersection", "regions": []}}},
        REGION,
    ),
    "intersections in each other": (
        {
            "parametricEstimator": {
                **PARAMETRIC,
                "region": NESTED,
            }
        },
        f"{REGION}/regions/0",
    ),
    "a disc without radius": (
        {"parametricEstimator": {**PARAMETRIC, "region": {"kind": "disc", "radius": 0.0}}},
        REGION,
    ),
    "a region smaller than the margin": (
        {"parametricEstimator": {**PARAMETRIC, "margin": 0.2, "region": {"kind": "disc", "radius": 0.1}}},
        "/parametricEstimator/margin",
    ),
    "no such region": ({"parametricEstimator": {**PARAMETRIC, "region": {"kind": "square"}}}, REGION),
    "no such estimator": ({"subspaceEstimator": {"kind": "magic"}}, "/subspaceEstimator"),
    "an order among the options": (
        {"parametricEstimator": {**PARAMETRIC, "order": 3}},
        "/parametricEstimator/order",
    ),
    "no order": (
        {"parametricEstimator": PARAMETRIC, "structure": {**responses.STRUCTURE, "order": None}},
        "/structure",
    ),
    "order zero": (
        {"parametricEstimator": PARAMETRIC, "structure": {**responses.STRUCTURE, "order": 0}},
        "/structure/order",
    ),
    "a rational structure": (
        {"parametricEstimator": PARAMETRIC, "structure": paper.PLANT["structure"]},
        "/structure",
    ),
    "another sample time": (
        {"parametricEstimator": PARAMETRIC, "structure": {**responses.STRUCTURE, "sampleTimeSeconds": 0.5}},
        "/experimentIds/0",
    ),
    "continuous time": (
        {"parametricEstimator": PARAMETRIC, "structure": {"timeDomain": "continuousStateSpace", "order": 3}},
        "/experimentIds/0",
    ),
    "a hold undone in discrete time": (
        {"subspaceEstimator": {**SUBSPACE, "zeroOrderHold": True}},
        "/subspaceEstimator/zeroOrderHold",
    ),
    "a basis of too many functions": (
        {"parametricEstimator": PARAMETRIC, "basis": {"factors": [{"kind": "polynomial", "degree": 4}]}},
        "/experimentIds",
    ),
    "a matrix that is not there": (
        {"parametricEstimator": PARAMETRIC, "coefficientBases": [{"coefficient": "E", "basis": responses.AFFINE}]},
        "/coefficientBases",
    ),
    "refinement of nothing": (
        {"subspaceEstimator": SUBSPACE, "refinement": {"kind": "state_space_likelihood"}},
        "/refinement",
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_bad_models(api: Api, plant: Json, exact: list[str], name: str) -> None:
    change, pointer = MODELS[name]
    problem = api.refused("/models/state-space", {"plantId": plant["id"], "experimentIds": exact, **change})
    assert problem["status"] == 422
    assert pointers(problem) == [pointer]
    assert problem["errors"][0]["detail"]


LATE: dict[str, tuple[Json, str, str]] = {
    "too few lines for q": ({"parametricEstimator": {**PARAMETRIC, "blockRows": 58}}, "/experimentIds", "too few"),
    "too few lines at a point": ({"subspaceEstimator": {**SUBSPACE, "blockRows": 58}}, "/experimentIds/0", "too few"),
    "no equidistant lines": (
        {"subspaceEstimator": {"kind": "equidistant_subspace"}},
        "/experimentIds/0",
        "begin at zero",
    ),
    "no variances": (
        {"subspaceEstimator": {**SUBSPACE, "weighting": "variance"}},
        "/subspaceEstimator/weighting",
        "variance",
    ),
}


@pytest.mark.parametrize("name", LATE)
def test_jobs_that_the_data_do_not_fit(api: Api, plant: Json, exact: list[str], name: str) -> None:
    options, pointer, reason = LATE[name]
    with pytest.raises(JobFailedError) as failure:
        api.made("/models/state-space", {"plantId": plant["id"], "experimentIds": exact, **options})
    problem = failure.value.problem
    assert (problem["status"], pointers(problem)) == (422, [pointer])
    assert reason in problem["detail"]


PLANTS: dict[str, tuple[Json, str]] = {
    "no inputs": ({"inputs": None}, "/inputs"),
    "an empty list": ({"outputs": []}, "/outputs"),
    "two of one name": ({"inputs": [{"name": "u"}, {"name": "u"}]}, "/inputs"),
    "an input of its own": ({"input": {"name": "u"}}, "/input"),
    "inputs of a rational plant": ({**paper.PLANT, "inputs": responses.PLANT["inputs"]}, "/inputs"),
    "order zero": ({"structure": {**responses.STRUCTURE, "order": 0}}, "/structure/order"),
    "a sample time in continuous time": (
        {"structure": {**responses.STRUCTURE, "timeDomain": "continuousStateSpace"}},
        "/structure/sampleTimeSeconds",
    ),
    "a matrix that is not there": (
        {"coefficientBases": [{"coefficient": "a1", "basis": responses.AFFINE}]},
        "/coefficientBases",
    ),
    "too large": (
        {
            "structure": {**responses.STRUCTURE, "order": 100},
            "basis": {"factors": [{"kind": "chebyshev", "degree": 9}]},
        },
        "/basis",
    ),
}


@pytest.mark.parametrize("name", PLANTS)
def test_bad_plants(api: Api, name: str) -> None:
    change, pointer = PLANTS[name]
    problem = api.refused("/plants", {**responses.PLANT, **change})
    assert (problem["status"], pointers(problem)) == (422, [pointer])
