"""One request makes a plant with experiments; the loop finds what the plant hides."""

import pytest

from tests.support.api import Api, Json, pointers

IDENTIFICATION = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "generalised_least_squares"},
    "spectralEstimator": {"kind": "periodic_average"},
}


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
    assert "hidden" not in api.made("/examples", {"hiddenEffect": "none"})


def test_what_cannot_be_hidden_is_refused(api: Api) -> None:
    assert pointers(api.refused("/examples", {"hiddenEffect": "goblin"})) == ["/hiddenEffect"]
    assert pointers(api.refused("/examples", {"seed": -1})) == ["/seed"]


@pytest.fixture(scope="module")
def signals(api: Api, example: Json) -> Json:
    plant = example["plantId"]
    experiments = example["experimentIds"][:6]
    model = api.made("/models", {"plantId": plant, "experimentIds": experiments, **IDENTIFICATION})
    design = api.made(
        "/designs",
        {
            "plantId": plant,
            "modelId": model["id"],
            "operatingPoints": {"kind": "gridAxes", "axes": [{"minimum": 0.0, "maximum": 0.6, "count": 7}]},
            "targets": [{"kind": "parameter_deviation", "standardDeviations": [1e-4, 2e-4, 5e-4, 8e-5]}],
            "spectrumFamily": {"kind": "lines", "samples": 512},
            "samples": 2048,
            "sampleTimeSeconds": 0.008,
            "band": {"minimumRadPerSecond": 5.0, "maximumRadPerSecond": 160.0},
        },
    )
    return api.made(f"/designs/{design['id']}/signals", {"samples": 512, "periods": 4})


def test_designed_signals_are_played_on_it(api: Api, example: Json, signals: Json) -> None:
    body = {"signalsId": signals["id"], "seed": 3}
    found = api.made(f"/examples/{example['id']}/measurements", body)
    assert found["designId"] == signals["designId"]
    for name, signal in zip(found["experimentIds"], signals["signals"], strict=True):
        experiment = api.get(f"/experiments/{name}")
        assert experiment["designId"] == signals["designId"]
        assert experiment["operatingPoint"] == signal["operatingPoint"]
        assert experiment["understood"]["periods"] == 4
        played = api.get(f"/experiments/{name}/data")["input"]
        assert sum(value**2 for value in played) == pytest.approx(signal["energy"])


def test_signals_of_another_plant_are_refused(api: Api, signals: Json) -> None:
    other = api.made("/examples", {"hiddenEffect": "none", "seed": 9})["id"]
    assert pointers(api.refused(f"/examples/{other}/measurements", {"signalsId": signals["id"]})) == ["/signalsId"]
    assert pointers(api.refused(f"/examples/{other}/measurements", {"signalsId": "nothing"})) == ["/signalsId"]
