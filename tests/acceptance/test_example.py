"""One request makes a plant with experiments; the loop finds what the plant hides."""

import pytest

from tests.support.api import Api, Json, pointers
from tests.support.server import Server

IDENTIFICATION = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "generalised_least_squares"},
    "spectralEstimator": {"kind": "periodic_average"},
}


@pytest.fixture(scope="module")
def api(server: Server) -> Api:
    return Api(server.url)


@pytest.fixture(scope="module")
def example(api: Api) -> Json:
    return api.made("/examples", {"hiddenEffect": "quadratic_damping", "seed": 5, "name": "a stage"})


def test_plant_and_experiments_are_there(api: Api, example: Json) -> None:
    plant = api.get(f"/plants/{example['plantId']}")
    assert plant["name"] == "a stage"
    experiments = {one["id"]: one for one in api.get("/experiments", plantId=plant["id"], limit=100)["items"]}
    assert set(experiments) == {*example["experimentIds"], *example["heldOutExperimentIds"]}
    for one in experiments.values():
        assert one["understood"]["noiseLevel"] == pytest.approx(example["noiseStandardDeviation"], rel=0.15)
        assert one["understood"]["periods"] == 4
    seen = {experiments[name]["operatingPoint"][0] for name in example["experimentIds"]}
    assert not seen & {experiments[name]["operatingPoint"][0] for name in example["heldOutExperimentIds"]}
    assert api.get("/examples")["items"][0]["id"] == example["id"]


def test_the_loop_finds_what_it_hides(api: Api, example: Json) -> None:
    fitted, held_out = example["experimentIds"], example["heldOutExperimentIds"]
    model = api.made("/models", {"plantId": example["plantId"], "experimentIds": fitted, **IDENTIFICATION})
    assert model["noiseVariance"] == pytest.approx(example["noiseStandardDeviation"] ** 2, rel=0.1)
    found = api.made("/diagnoses", {"modelId": model["id"], "experimentIds": fitted})
    assert found["announced"][0] == example["hidden"]["kind"] == "quadratic_damping"
    body = {"effect": found["announced"][0], "experimentIds": fitted, "heldOutExperimentIds": held_out}
    grown = api.made(f"/models/{model['id']}/extensions", body)
    assert grown["extension"]["after"]["heldOut"] < 0.6 * grown["extension"]["before"]["heldOut"]
    assert grown["extension"]["after"]["lackOfFit"]["pValue"] > 1e-3
    amplitude, deviation = (grown["effects"][0][name][0][0] for name in ("coefficients", "standardDeviations"))
    assert abs(amplitude - example["hidden"]["amplitude"]) < 4 * deviation


def test_the_seed_decides_what_is_hidden(api: Api) -> None:
    hidden = [api.made("/examples", {"seed": seed})["hidden"] for seed in (1, 1, 2)]
    assert hidden[0] == hidden[1] != hidden[2]
    assert api.made("/examples", {"hiddenEffect": "none"})["hidden"] is None


def test_what_cannot_be_hidden_is_refused(api: Api) -> None:
    assert pointers(api.refused("/examples", {"hiddenEffect": "goblin"})) == ["/hiddenEffect"]
    assert pointers(api.refused("/examples", {"seed": -1})) == ["/seed"]
