"""Models of every kind are asked for at one address; the older addresses answer from the same code."""

from typing import Any

import pytest

from tests.support import responses, varying
from tests.support.api import Api, Json, pointers

SUBSPACE = {"subspaceEstimator": {"kind": "frequency_subspace"}}


@pytest.fixture(scope="module")
def asked(api: Api) -> Json:
    plant = api.post("/plants", responses.PLANT)
    data = [responses.measured(point, 0.01) for point in responses.POINTS]
    made = [api.made("/experiments", responses.body(plant, one))["id"] for one in data]
    return {"plantId": plant["id"], "experimentIds": made, **SUBSPACE}


def submitted(api: Api, path: str, body: Any, key: str) -> Json:
    answer = api.http.post(path, json=body, headers={"Idempotency-Key": key})
    assert answer.status_code == 202, answer.text
    job: Json = answer.json()
    return job


def test_the_older_address_is_the_same_request(api: Api, asked: Json) -> None:
    old = submitted(api, "/models/state-space", asked, "one state space")
    new = submitted(api, "/models", {"kind": "stateSpace", **asked}, "one state space")
    assert new["id"] == old["id"]
    assert api.result(new)["stateSpace"]["subspaceEstimator"]["kind"] == "frequency_subspace"


def test_problems_point_into_the_request_of_their_kind(api: Api, asked: Json) -> None:
    worse = {**asked, "kind": "stateSpace", "subspaceEstimator": {"kind": "frequency_subspace", "blockRows": 0}}
    (pointer,) = pointers(api.refused("/models", worse))
    assert pointer.startswith("/subspaceEstimator")
    assert pointers(api.refused("/models", {**asked, "kind": "varyingScheduling"}))[0] == "/experimentId"
    problem = api.refused("/models", {**asked, "kind": "neural"})
    assert "varyingScheduling" in problem["errors"][0]["detail"]


def test_a_request_of_one_kind_is_refused_at_the_address_of_another(api: Api, asked: Json) -> None:
    assert pointers(api.refused("/models/varying", {"kind": "stateSpace", **asked}))[0] == "/kind"


def test_a_body_without_a_kind_is_rational_as_before(api: Api, asked: Json) -> None:
    estimators = {"localEstimator": {"kind": "rational_fit"}, "lpvEstimator": {"kind": "joint_likelihood"}}
    without = {name: asked[name] for name in ("plantId", "experimentIds")}
    problem = api.refused("/models", {**without, **estimators})
    assert "kind stateSpace" in problem["detail"]


def test_the_catalogue_says_what_each_method_takes(api: Api) -> None:
    methods = {one["kind"]: one for one in api.get("/catalogue")["methods"]}
    assert methods["two_step"]["requestKind"] == "rational"
    assert methods["two_step"]["structures"] == ["discrete", "continuous", "continuousPhysical"]
    assert methods["two_step"]["takesPrior"]
    assert methods["along_scheduling"]["experiments"] == ["varyingRecord"]
    assert methods["along_scheduling"]["requestKind"] == "varyingScheduling"
    assert "matrixFrequencyResponse" in methods["subspace_likelihood"]["experiments"]


def test_a_record_along_varying_scheduling_belongs_to_its_kind(api: Api) -> None:
    plant = api.post("/plants", varying.TURBINE)
    record = api.made("/experiments", varying.body(plant, varying.turbine(1)))["id"]
    body = {"kind": "stateSpace", "plantId": plant["id"], "experimentIds": [record], **SUBSPACE}
    problem = api.refused("/models", body)
    assert pointers(problem) == ["/experimentIds/0"]
    assert "varyingScheduling" in problem["detail"]
