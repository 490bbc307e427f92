"""The design to begin with: from any model, at the first click."""

from tests.support.api import Api, Json
from tests.support.paper import prepared

IDENTIFICATION = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "generalised_least_squares"},
    "spectralEstimator": {"kind": "periodic_average"},
}


def model_of_example(api: Api, effect: str) -> tuple[Json, Json]:
    example = api.made("/examples", {"hiddenEffect": effect, "seed": 5})
    body = {"plantId": example["plantId"], "experimentIds": example["experimentIds"], **IDENTIFICATION}
    return example, api.made("/models", body)


def check_design(api: Api, model: Json) -> Json:
    """The usual design of a model."""
    usual = api.get(f"/models/{model['id']}/usual-design")
    design = api.made("/designs", usual)
    assert design["outcome"]["status"] == "converged", design["outcome"]
    assert design["experiments"]
    return design


def test_a_model_of_the_example_gives_a_design_as_it_is_and_with_an_effect_on_signals(api: Api) -> None:
    example, model = model_of_example(api, "quadratic_damping")
    design = check_design(api, model)
    experiments = api.get("/experiments", plantId=example["plantId"], limit=100)["items"]
    assert design["sampleTimeSeconds"] == experiments[0]["sampleTimeSeconds"]
    assert design["request"]["spectrumFamily"]["kind"] == "lines"
    assert design["request"]["usePriorInformation"] is True
    body = {"effect": "quadratic_damping", "experimentIds": example["experimentIds"]}
    extended = api.made(f"/models/{model['id']}/extensions", body)
    grown = check_design(api, extended)
    assert grown["request"]["spectrumFamily"]["kind"] == "multisines"
    assert all(one["spectrum"]["level"] > 0 for one in grown["experiments"])
    assert api.made(f"/designs/{grown['id']}/signals", {})["signals"]


def test_a_stated_model_without_experiments_or_covariance_gives_a_design(api: Api) -> None:
    plant, model = prepared(api)
    design = check_design(api, model)
    assert design["request"]["plantId"] == plant["id"]
    assert design["request"]["usePriorInformation"] is False


def test_models_that_are_not_there_are_refused(api: Api) -> None:
    answer = api.http.get("models/nothing/usual-design")
    assert answer.status_code == 404
