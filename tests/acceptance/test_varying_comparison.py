"""Models from varying scheduling held against records along p(t) and against experiments at frozen points."""

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT
from tests.support import varying
from tests.support.api import Api, Json, pointers
from tests.support.responses import complex_array

POINTS = (-0.8, 0.0, 0.8)


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", varying.TURBINE)


@pytest.fixture(scope="module")
def records(api: Api, plant: Json) -> list[str]:
    bodies = [varying.body(plant, varying.turbine(seed)) for seed in (11, 12)]
    return [api.made("/experiments", body)["id"] for body in bodies]


@pytest.fixture(scope="module")
def still(api: Api, plant: Json) -> list[str]:
    bodies = [{**varying.still(point, 3), "plantId": plant["id"]} for point in POINTS]
    return [api.made("/experiments", body)["id"] for body in bodies]


@pytest.fixture(scope="module")
def model(api: Api, plant: Json, records: list[str]) -> Json:
    request = {"plantId": plant["id"], "experimentId": records[0], "estimator": {"kind": "periodic_likelihood"}}
    return api.made("/models/varying", request)


def compared(api: Api, model: Json, experiments: list[str]) -> Json:
    return api.made("/comparisons", {"modelId": model["id"], "experimentIds": experiments})


def test_one_comparison_holds_all_kinds_of_experiments(
    api: Api, model: Json, records: list[str], still: list[str]
) -> None:
    found = compared(api, model, [records[0], *still, records[1]])
    parts = [(part["scheduling"], part["data"], part.get("experimentId")) for part in found["parts"]]
    assert parts == [
        ("still", "heldOut", None),
        ("varying", "fitted", records[0]),
        ("varying", "heldOut", records[1]),
    ]
    assert all(part["noiseKnown"] and part["lackOfFit"]["pValue"] > 1e-3 for part in found["parts"])
    assert [len(part["byBand"]) for part in found["parts"][1:]] == [6, 6]
    assert [one.get("operatingPoint") for one in found["experiments"]] == [None, *([p] for p in POINTS), None]
    assert all(one["fitPercent"] > 85 for one in found["experiments"])
    assert found["experiments"][4]["vafPercent"] > 98
    maps = api.get(f"/comparisons/{found['id']}/maps")
    assert [row.get("operatingPoint") for row in maps["rows"]] == [None, *([p] for p in POINTS), None]
    for row in (maps["rows"][0], maps["rows"][4]):
        assert np.mean(abs(complex_array(row["residual"])) ** 2) == pytest.approx(1, abs=0.6)
    over_time = maps["timeRows"]
    assert [row["experimentId"] for row in over_time] == [records[0], records[1]]
    assert np.std(over_time[0]["residual"]) == pytest.approx(1, abs=0.1)
    assert len(over_time[0]["residual"]) == varying.PERIOD * varying.PERIODS
    assert len(api.download(f"/comparisons/{found['id']}/file", format="npz")) > 1000


def test_a_plant_that_has_changed_is_seen(api: Api, plant: Json, model: Json) -> None:
    u, y, p = varying.turbine(13)
    changed = api.made("/experiments", varying.body(plant, (u, 1.05 * y, p)))["id"]
    still = api.made("/experiments", {**varying.still(0.4, 4, gain=1.05), "plantId": plant["id"]})["id"]
    found = compared(api, model, [changed, still])
    assert all(part["lackOfFit"]["pValue"] < 1e-6 for part in found["parts"])
    diagnosis = api.made("/diagnoses", {"modelId": model["id"], "experimentIds": [still]})
    assert diagnosis["modelId"] == model["id"]


def test_local_and_varying_models_of_one_plant_agree_within_their_covariances(
    api: Api, plant: Json, model: Json, still: list[str]
) -> None:
    """Along p the local coefficients are polynomials: the determinant of A(p) has degree two."""
    local = api.made(
        "/models",
        {
            "plantId": plant["id"],
            "experimentIds": still,
            "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 2, "nb": 1, "nk": 1},
            "basis": {"factors": [{"kind": "polynomial", "degree": 2}]},
            "localEstimator": {"kind": "prediction_error"},
            "lpvEstimator": {"kind": "generalised_least_squares"},
        },
    )
    band = {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0, "count": 6}
    squares, sizes = [], []
    for point in (-0.6, 0.1, 0.7):
        one, other = (
            api.get(f"/models/{found['id']}/frequency-response", operatingPoint=[point], **band)
            for found in (local, model)
        )
        difference = complex_array(one["response"]) - complex_array(other["response"])
        for part, values in (("real", difference.real), ("imaginary", difference.imag)):
            variance = np.array(one[f"{part}Variance"]) + np.array(other[f"{part}Variance"])
            squares.append(values**2 / variance)
        sizes.append(np.max(abs(difference)) / np.max(one["magnitude"]))
    assert 0.1 < np.mean(squares) < 3
    assert max(sizes) < 0.1


DELAY = 0.3


def delayed_response(point: float, omega: np.ndarray) -> np.ndarray:
    return PLANT.frequency_response(np.array([[point]]), omega)[0, :, 0, 0] * np.exp(-1j * DELAY * omega)


@pytest.fixture(scope="module")
def late(api: Api, plant: Json) -> list[str]:
    """Frequency responses with a delay that the model does not know."""
    g = np.random.default_rng(8)
    experiments = []
    for point in (*POINTS, -0.4, 0.4, 0.6):
        omega = np.linspace(0.05, 3.0, 60)
        measured = delayed_response(point, omega) + 0.01 * g.standard_normal((2, 60)).T @ [1, 1j]
        request = {"plantId": plant["id"], "kind": "frequencyResponse", "operatingPoint": [point]}
        request |= {"sampleTimeSeconds": 1.0, "frequenciesRadPerSecond": omega.tolist(), "variance": [2e-4] * 60}
        request["response"] = {"re": measured.real.tolist(), "im": measured.imag.tolist()}
        experiments.append(api.made("/experiments", request)["id"])
    return experiments


@pytest.fixture(scope="module")
def grown(api: Api, model: Json, late: list[str]) -> Json:
    """The model with the delay that a diagnosis found."""
    found = api.made("/diagnoses", {"modelId": model["id"], "experimentIds": late[:5]})
    assert found["verdict"] in ("explained", "partlyExplained")
    assert "delay" in found["announced"]
    request = {
        "effect": "delay",
        "experimentIds": late[:5],
        "heldOutExperimentIds": late[5:],
        "diagnosisId": found["id"],
    }
    return api.made(f"/models/{model['id']}/extensions", request)


def test_its_steady_state_is_simulated(api: Api, grown: Json) -> None:
    waves = np.exp(2j * np.pi * np.arange(20) / 20)
    steady = {"kind": "periodic", "input": waves.imag.tolist(), "sampleTimeSeconds": 1.0, "operatingPoints": [[0.5]]}
    made = api.made(f"/models/{grown['id']}/simulations", {"excitation": steady})
    data = api.get(f"/simulations/{made['id']}/data")
    wanted = np.imag(delayed_response(0.5, np.array([2 * np.pi / 20])) * waves)
    assert np.linalg.norm(data["outputs"][0] - wanted) < 0.02 * np.linalg.norm(wanted)
    assert made["outputs"][0]["deviation"] > 0


def test_what_still_experiments_lack_is_diagnosed_and_added(
    api: Api, model: Json, grown: Json, late: list[str], records: list[str]
) -> None:
    assert (grown["origin"], grown["parentId"], grown["effects"][0]["kind"]) == ("extended", model["id"], "delay")
    report = grown["extension"]
    assert report["after"]["heldOut"] < 0.05 < report["before"]["heldOut"]
    assert report["after"]["lackOfFit"]["pValue"] > 1e-3
    deviation = grown["effects"][0]["standardDeviations"][0][0]
    assert abs(grown["effects"][0]["coefficients"][0][0] - DELAY) < 4 * deviation
    assert grown["jointParameterNames"][4] == "A[1](1,1)"
    assert len(grown["jointCovariance"]) == len(grown["jointParameterNames"]) == len(grown["theta"]) + 1
    band = {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0, "count": 30}
    response = api.get(f"/models/{grown['id']}/frequency-response", operatingPoint=[0.5], **band)
    error = complex_array(response["response"]) - delayed_response(0.5, np.array(response["frequenciesRadPerSecond"]))
    assert 0.1 < np.mean(error.real**2 / np.array(response["realVariance"])) < 3
    again = compared(api, grown, late[5:])
    assert again["parts"][0]["lackOfFit"]["pValue"] > 1e-3
    refused = api.refused("/comparisons", {"modelId": grown["id"], "experimentIds": [records[1]]})
    assert pointers(refused) == ["/experimentIds/0"]
    given = {"kind": "given", "inputs": [[1.0]], "scheduling": [[0.0]]}
    assert pointers(api.refused(f"/models/{grown['id']}/simulations", {"excitation": given})) == ["/modelId"]


def test_a_staircase_climbs_from_a_model_of_varying_scheduling(api: Api, model: Json, late: list[str]) -> None:
    request = {"experimentIds": late[:5], "heldOutExperimentIds": late[5:], "effects": ["delay", "lag"]}
    found = api.made(f"/models/{model['id']}/staircases", request)
    assert [step.get("added") for step in found["steps"]] == [None, "delay"]
    assert api.get(f"/models/{found['steps'][1]['modelId']}")["effects"][0]["kind"] == "delay"
    asked = {**request, "effects": ["delay", "cubic_dependence"]}
    assert pointers(api.refused(f"/models/{model['id']}/staircases", asked)) == ["/effects/1"]


def test_what_cannot_be_compared_or_diagnosed_says_why(
    api: Api, plant: Json, model: Json, records: list[str], still: list[str]
) -> None:
    diagnosis = {"modelId": model["id"], "experimentIds": [still[0], records[0]]}
    problem = api.refused("/diagnoses", diagnosis)
    assert pointers(problem) == ["/experimentIds/1"]
    assert "held still" in problem["detail"]
    along = compared(api, model, [records[0]])
    assert pointers(api.refused("/diagnoses", {"comparisonId": along["id"]})) == ["/comparisonId"]
    extension = {"effect": "quadratic_dependence", "experimentIds": still}
    assert pointers(api.refused(f"/models/{model['id']}/extensions", extension)) == ["/effect"]
    without = {"plantId": plant["id"], "experimentId": records[0], "estimator": {"kind": "periodic_moesp"}}
    moesp = api.made("/models/varying", without)
    assert pointers(api.refused("/comparisons", {"modelId": moesp["id"], "experimentIds": still})) == ["/modelId"]
    request = {"plantId": plant["id"], "experimentIds": [records[0]], "localEstimator": {"kind": "prediction_error"}}
    local = {**request, "lpvEstimator": {"kind": "generalised_least_squares"}}
    structure = {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 2, "nb": 1}
    assert pointers(api.refused("/models", {**local, "structure": structure})) == ["/experimentIds/0"]
