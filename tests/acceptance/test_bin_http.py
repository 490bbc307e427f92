"""Delete, undo and rename over HTTP: what depends on a resource is said before, and goes and comes with it."""

import numpy as np
import pytest

from tests.support.api import Api, Json, pointers
from tests.support.paper import NOISE_VARIANCE, PLANT, THETA

WAVE = np.random.default_rng(0).normal(size=80).tolist()


@pytest.fixture
def plant(api: Api) -> Json:
    return api.post("/plants", {**PLANT, "name": "to be deleted"})


def test_a_plant_goes_with_all_that_belongs_to_it_and_comes_back(api: Api, plant: Json) -> None:
    record = {"kind": "timeRecord", "operatingPoint": [1.0], "sampleTimeSeconds": 1.0, "input": WAVE, "output": WAVE}
    experiment = api.made("/experiments", {"plantId": plant["id"], "name": "first", **record})
    model = api.post("/models/stated", {"plantId": plant["id"], "theta": THETA, "noiseVariance": NOISE_VARIANCE})
    said = api.get(f"/plants/{plant['id']}/dependents")
    assert {one["id"] for one in said["items"]} == {experiment["id"], model["id"]}
    refusal = api.problem(api.http.delete(f"/plants/{plant['id']}"))
    assert refusal["status"] == 409
    assert "withDependents=true" in refusal["detail"]
    gone = api.http.delete(f"/plants/{plant['id']}", params={"withDependents": "true"})
    assert gone.status_code == 200
    assert len(gone.json()["items"]) == 3
    for path in (f"/plants/{plant['id']}", f"/experiments/{experiment['id']}", f"/models/{model['id']}"):
        assert api.http.get(path).status_code == 404
    assert plant["id"] not in [one["id"] for one in api.get("/plants", limit=500)["items"]]
    (entry,) = [one for one in api.get("/bin")["items"] if one["id"] == plant["id"]]
    assert entry["others"] == 2
    assert entry["resource"]["name"] == "to be deleted"
    api.post(f"/bin/{plant['id']}/restoration", {})
    assert api.get(f"/plants/{plant['id']}") == plant
    assert api.get(f"/experiments/{experiment['id']}") == experiment
    assert api.get(f"/models/{model['id']}") == model


def test_names_and_descriptions_change_and_nothing_else(api: Api, plant: Json) -> None:
    answer = api.http.patch(f"/plants/{plant['id']}", json={"name": "renamed", "description": "what it is"})
    assert answer.status_code == 200
    assert answer.json()["name"] == "renamed"
    assert api.get(f"/plants/{plant['id']}") == {**plant, "name": "renamed", "description": "what it is"}
    for body, pointer in (({}, ""), ({"name": ""}, "/name"), ({"theta": []}, "/theta")):
        problem = api.problem(api.http.patch(f"/plants/{plant['id']}", json=body))
        assert pointers(problem) == [pointer]
    assert api.problem(api.http.patch(f"/plants/{'0' * 32}", json={"name": "x"}))["status"] == 404
    assert api.problem(api.http.delete(f"/jobs/{'0' * 32}"))["status"] in (405, 422)
