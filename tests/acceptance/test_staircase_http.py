"""A staircase through HTTP: effects added until noise explains what is left, every version kept."""

import numpy as np
import pytest

from tests.acceptance.test_example import IDENTIFICATION
from tests.support.api import Api, Json, pointers


@pytest.fixture(scope="module")
def example(api: Api) -> Json:
    return api.made("/examples", {"hiddenEffect": "dead_zone", "seed": 8})


@pytest.fixture(scope="module")
def model(api: Api, example: Json) -> Json:
    body = {"plantId": example["plantId"], "experimentIds": example["experimentIds"], **IDENTIFICATION}
    return api.made("/models", body)


@pytest.fixture(scope="module")
def staircase(api: Api, example: Json, model: Json) -> Json:
    body = {"experimentIds": example["experimentIds"], "heldOutExperimentIds": example["heldOutExperimentIds"]}
    return api.made(f"/models/{model['id']}/staircases", {**body, "largest": 2, "name": "down"})


def test_it_ends_at_the_noise_with_the_right_effect(model: Json, staircase: Json) -> None:
    assert staircase["conclusion"] == "explained"
    steps = staircase["steps"]
    assert steps[0]["modelId"] == model["id"] == staircase["modelId"]
    assert [step.get("added") for step in steps[:2]] == [None, "dead_zone"]
    errors = np.array([[step["fitted"], step["heldOut"]] for step in steps])
    assert np.all(np.diff(errors[:, 1]) <= 0)
    assert errors[1, 1] < 0.3 * errors[0, 1]
    assert steps[0]["lackOfFit"]["pValue"] < 1e-9 < 1e-3 < steps[-1]["lackOfFit"]["pValue"]


def test_every_version_and_every_diagnosis_is_kept_and_points_to_the_others(
    api: Api, example: Json, model: Json, staircase: Json
) -> None:
    parent = model["id"]
    for before, step in zip(staircase["steps"], staircase["steps"][1:], strict=False):
        version = api.get(f"/models/{step['modelId']}")
        assert version["parentId"] == parent
        assert version["effects"][-1]["kind"] == step["added"]
        assert version["experimentIds"] == example["experimentIds"]
        assert version["extension"]["diagnosisId"] == before["diagnosisId"]
        assert version["extension"]["before"]["heldOut"] == before["heldOut"]
        assert version["extension"]["after"]["heldOut"] == step["heldOut"]
        parent = version["id"]
    for step in staircase["steps"]:
        diagnosis = api.get(f"/diagnoses/{step['diagnosisId']}")
        assert diagnosis["modelId"] == step["modelId"]
        assert diagnosis["lackOfFit"] == step["lackOfFit"]
    assert api.get("/staircases", plantId=example["plantId"])["items"] == [staircase]


def test_a_version_of_it_can_be_compared_and_reported(api: Api, example: Json, staircase: Json) -> None:
    version = staircase["steps"][1]["modelId"]
    body = {"modelId": version, "experimentIds": example["heldOutExperimentIds"]}
    assert api.made("/comparisons", body)["parts"][0]["lackOfFit"]["pValue"] > 1e-4
    report = api.made(f"/models/{version}/reports", {})
    assert report["diagnosisIds"][0] == staircase["steps"][0]["diagnosisId"]


def test_what_does_not_fit_is_refused(api: Api, example: Json, model: Json) -> None:
    path, fitted = f"/models/{model['id']}/staircases", example["experimentIds"]
    known = {"experimentIds": fitted, "heldOutExperimentIds": fitted[:1]}
    assert pointers(api.refused(path, known)) == ["/heldOutExperimentIds/0"]
    assert pointers(api.refused(path, {"experimentIds": fitted, "effects": ["goblin"]})) == ["/effects/0"]
    assert pointers(api.refused(path, {"experimentIds": fitted, "largest": 0})) == ["/largest"]
    assert api.http.post("/models/nothing/staircases", json={"experimentIds": fitted}).status_code == 404
