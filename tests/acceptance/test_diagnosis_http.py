"""Compare, diagnose and extend through HTTP: a plant with a hidden effect, integrated by a loop of the tests' own."""

import io
from itertools import pairwise

import numpy as np
import pytest

from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.hidden_plant import PLANT, HiddenPlant

CUBIC = 6.0
FITTED = [-1.0, -0.6, -0.2, 0.2, 0.6, 1.0]
HELD_OUT = [-0.8, 0.4]
LEVELS = (20.0, 10.0)
IDENTIFICATION = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "generalised_least_squares"},
    "spectralEstimator": {"kind": "periodic_average"},
}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


def brought_in(api: Api, plant: Json, points: list[float], seed: int) -> list[str]:
    hidden = HiddenPlant(CUBIC)
    bodies = [body for i, level in enumerate(LEVELS) for body in hidden.records(points, level, seed + i)]
    return [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in bodies]


@pytest.fixture(scope="module")
def fitted(api: Api, plant: Json) -> list[str]:
    return brought_in(api, plant, FITTED, 1)


@pytest.fixture(scope="module")
def held_out(api: Api, plant: Json) -> list[str]:
    return brought_in(api, plant, HELD_OUT, 11)


@pytest.fixture(scope="module")
def model(api: Api, plant: Json, fitted: list[str]) -> Json:
    return api.made("/models", {"plantId": plant["id"], "experimentIds": fitted, **IDENTIFICATION})


@pytest.fixture(scope="module")
def comparison(api: Api, model: Json, fitted: list[str], held_out: list[str]) -> Json:
    return api.made("/comparisons", {"modelId": model["id"], "experimentIds": fitted + held_out})


def test_the_comparison_shows_the_failure(comparison: Json, fitted: list[str], held_out: list[str]) -> None:
    assert [part["data"] for part in comparison["parts"]] == ["fitted", "heldOut"]
    for part in comparison["parts"]:
        assert part["noiseKnown"]
        assert part["lackOfFit"]["pValue"] < 1e-9
        assert part["lackOfFit"]["statistic"] > 1.5 * part["lackOfFit"]["degreesOfFreedom"]
        assert all("pValue" in test for test in part["byLineClass"])
        bands = part["byBand"]
        assert len(bands) >= 7
        assert all(a["maximumRadPerSecond"] == b["minimumRadPerSecond"] for a, b in pairwise(bands))
        assert max(bands, key=lambda one: one["test"]["statistic"])["minimumRadPerSecond"] < 12.0
    points = [point["operatingPoint"] for point in comparison["parts"][0]["byPoint"]]
    assert points == [[p] for p in FITTED]
    assert [one["experimentId"] for one in comparison["experiments"]] == fitted + held_out
    assert [one["data"] for one in comparison["experiments"]] == ["fitted"] * len(fitted) + ["heldOut"] * len(held_out)
    percent = [one["fitPercent"] for one in comparison["experiments"]]
    assert 70 < min(percent) < max(percent) < 100, percent
    assert np.median(percent) < 98.5, percent


def test_the_line_classes_show_an_odd_nonlinearity(comparison: Json) -> None:
    ratios = {
        test["name"]: test["statistic"] / test["degreesOfFreedom"] for test in comparison["parts"][0]["byLineClass"]
    }
    assert ratios["unexcited odd"] > 1.5 or ratios["excited"] > 2


def test_the_maps_are_those_of_the_tests(api: Api, comparison: Json) -> None:
    rows = api.get(f"/comparisons/{comparison['id']}/maps")["rows"]
    assert [row["experimentId"] for row in rows] == [one["experimentId"] for one in comparison["experiments"]]
    energy = {"fitted": 0.0, "heldOut": 0.0}
    for row in rows:
        assert len(row["frequenciesRadPerSecond"]) == len(row["residual"]["re"]) == len(row["lineClasses"])
        assert all(low < high for low, high in pairwise(row["frequenciesRadPerSecond"]))
        z = np.array(row["residual"]["re"]) + 1j * np.array(row["residual"]["im"])
        weight = np.full(len(z), 2.0)
        weight[[0, -1]] = 1.0
        energy[row["data"]] += float(weight @ abs(z) ** 2)
    assert energy["fitted"] == pytest.approx(comparison["parts"][0]["lackOfFit"]["statistic"], rel=1e-6)
    arrays = np.load(io.BytesIO(api.download(f"/comparisons/{comparison['id']}/file", format="npz")))
    for i, row in enumerate(rows):
        np.testing.assert_allclose(arrays[f"residual{i}"].real, row["residual"]["re"])
        assert arrays["operatingPoints"][i].tolist() == row["operatingPoint"]
    assert api.get("/comparisons", plantId=comparison["plantId"])["items"][0]["id"] == comparison["id"]


def test_the_responses_are_what_the_residuals_say(api: Api, comparison: Json) -> None:
    """(G_measured − G_modelled)/σ at the excited lines is the residual, up to the randomness of σ̂."""
    row = api.get(f"/comparisons/{comparison['id']}/maps")["rows"][0]
    found = api.get(f"/comparisons/{comparison['id']}/responses/{row['experimentId']}")
    excited = [i for i, name in enumerate(row["lineClasses"]) if name == "excited"]
    assert found["frequenciesRadPerSecond"] == [row["frequenciesRadPerSecond"][i] for i in excited]
    measured, modelled = (np.array(found[n]["re"]) + 1j * np.array(found[n]["im"]) for n in ("measured", "modelled"))
    ratio = abs(measured - modelled) / found["standardDeviation"]
    residual = abs(np.array(row["residual"]["re"]) + 1j * np.array(row["residual"]["im"]))[excited]
    assert np.median(ratio / residual) == pytest.approx(1.0, abs=0.15)
    assert np.ptp(ratio / residual) < 1e-6
    missing = api.http.get(f"/comparisons/{comparison['id']}/responses/elsewhere")
    assert api.problem(missing)["status"] == 404


@pytest.fixture(scope="module")
def diagnosis(api: Api, comparison: Json) -> Json:
    return api.made("/diagnoses", {"comparisonId": comparison["id"], "name": "what is missing"})


def test_the_diagnosis_ranks_the_right_effect_first(diagnosis: Json, fitted: list[str]) -> None:
    assert diagnosis["experimentIds"] == fitted
    assert diagnosis["verdict"] == "explained"
    first = diagnosis["ranking"][0]
    assert first["kind"] == "cubic_stiffness" == diagnosis["announced"][0]
    assert first["announced"]
    assert first["adjustedPValue"] < 1e-3
    assert first["evidence"]["weight"] > 0.95
    assert first["evidence"]["chiSquareExplained"] > 100
    assert diagnosis["lackOfFit"]["pValue"] < 1e-9 < 1e-3 < diagnosis["remaining"]["pValue"]


def test_the_amplitude_has_its_unit_and_lies_within_its_uncertainty(diagnosis: Json) -> None:
    effect = diagnosis["ranking"][0]["evidence"]["effect"]
    amplitude, deviation = effect["coefficients"][0][0], effect["standardDeviations"][0][0]
    assert effect["unit"]
    assert 0 < deviation < 0.05 * CUBIC
    assert abs(amplitude - CUBIC) < 4 * deviation


def test_confusability_and_visibility(diagnosis: Json) -> None:
    matrix = np.array(diagnosis["confusability"])
    assert matrix.shape == (len(diagnosis["ranking"]),) * 2
    np.testing.assert_allclose(matrix, matrix.T)
    np.testing.assert_allclose(np.diagonal(matrix), 1.0)
    assert 0 <= matrix.min() <= matrix.max() <= 1
    status = {one["kind"]: one for one in diagnosis["visibility"]}
    assert status["second_variable"]["status"] == "notJudged"
    assert status["second_variable"]["reason"]
    assert status["cubic_stiffness"]["status"] == "visible"
    assert 0 < status["cubic_stiffness"]["detectableAmplitude"] < CUBIC
    assert {one["kind"] for one in diagnosis["ranking"]} == {k for k, v in status.items() if v["status"] == "visible"}


def test_the_picture_of_what_is_missing_stands_out_of_its_noise(diagnosis: Json, fitted: list[str]) -> None:
    assert [row["experimentId"] for row in diagnosis["missing"]] == fitted
    row = diagnosis["missing"][0]
    size = np.hypot(row["response"]["re"], row["response"]["im"])
    assert np.max(size / np.array(row["standardDeviation"])) > 5
    assert [one["kind"] for one in row["explained"]] == [one["kind"] for one in diagnosis["ranking"][:3]]
    left = [
        np.hypot(*(np.array(row["response"][part]) - np.array(one["response"][part]) for part in ("re", "im")))
        for one in row["explained"]
    ]
    assert np.median(left[0] / np.array(row["standardDeviation"])) < 2
    assert np.median(left[0]) < np.median(size) / 4


@pytest.fixture(scope="module")
def extended(api: Api, model: Json, diagnosis: Json, fitted: list[str], held_out: list[str]) -> Json:
    body = {
        "effect": diagnosis["announced"][0],
        "experimentIds": fitted,
        "heldOutExperimentIds": held_out,
        "diagnosisId": diagnosis["id"],
    }
    return api.made(f"/models/{model['id']}/extensions", body)


def test_the_held_out_error_falls(extended: Json) -> None:
    before, after = extended["extension"]["before"], extended["extension"]["after"]
    assert after["heldOut"] < 0.3 * before["heldOut"]
    assert after["fitted"] < 0.3 * before["fitted"]
    noise = 0.01 / np.sqrt(4) * np.sqrt(2 * 75 / 512)  # four periods, 75 of 256 lines
    assert after["heldOut"] == pytest.approx(noise, rel=0.15)
    assert before["lackOfFit"]["pValue"] < 1e-9 < 1e-3 < after["lackOfFit"]["pValue"]


def test_the_new_version_stands_beside_the_old(api: Api, model: Json, extended: Json, diagnosis: Json) -> None:
    assert extended["parentId"] == model["id"]
    assert extended["origin"] == "extended"
    assert extended["extension"]["diagnosisId"] == diagnosis["id"]
    assert api.get(f"/models/{model['id']}") == model
    assert model["effects"] == []


def test_parameters_of_plant_and_effect_come_with_their_joint_covariance(extended: Json) -> None:
    covariance = np.array(extended["jointCovariance"])
    names = extended["jointParameterNames"]
    assert names == [*extended["parameterNames"], "cubic_stiffness.e[0]"]
    values = np.array([*extended["theta"], extended["effects"][0]["coefficients"][0][0]])
    error = values - np.array([1.8, 64.0, 28.0, 1.0, CUBIC])
    assert float(error @ np.linalg.solve(covariance, error)) < 20.5  # 99.9 % of χ²(5)
    np.testing.assert_allclose(extended["covariance"], covariance[:-1, :-1])


def test_its_frequency_response_is_that_of_the_linear_core(api: Api, extended: Json) -> None:
    query = {"operatingPoint": 0.5, "minimumRadPerSecond": 1.0, "maximumRadPerSecond": 20.0, "count": 30}
    found = api.get(f"/models/{extended['id']}/frequency-response", **query)
    assert found["leftOutEffects"] == ["cubic_stiffness"]
    response = np.array(found["response"]["re"]) + 1j * np.array(found["response"]["im"])
    omega = np.array(found["frequenciesRadPerSecond"])
    exact = 1 / (64.0 + 28.0 * 0.5 - omega**2 + 1.8j * omega)
    np.testing.assert_allclose(response, exact, rtol=0.02)
    half_width = (np.array(found["magnitudeUpper95"]) - np.array(found["magnitudeLower95"])) / 2
    assert np.all(abs(abs(response) - abs(exact)) < 2.5 * half_width)


def test_an_extended_model_is_compared_and_diagnosed_like_one_without(
    api: Api, extended: Json, fitted: list[str], held_out: list[str]
) -> None:
    compared = api.made("/comparisons", {"modelId": extended["id"], "experimentIds": fitted + held_out})
    assert all(part["lackOfFit"]["pValue"] > 1e-3 for part in compared["parts"])
    assert all(one["fitPercent"] > 99 for one in compared["experiments"])
    again = api.made("/diagnoses", {"comparisonId": compared["id"], "effects": ["cubic_stiffness", "delay", "lag"]})
    assert again["verdict"] == "nothingMissing"
    assert again["announced"] == []
    assert {one["kind"] for one in again["visibility"]} == {"cubic_stiffness", "delay", "lag"}


def responses(points: list[float], delay: float, freedom: float | None = None) -> list[Json]:
    """Bodies of frequency responses of the plant without stiffening, but with a delay, known to one per cent."""
    omega, generator, bodies = np.linspace(0.5, 25.0, 80), np.random.default_rng(3), []
    for p in points:
        exact = np.exp(-1j * omega * delay) / (64.0 + 28.0 * p - omega**2 + 1.8j * omega)
        noise = generator.standard_normal(80) + 1j * generator.standard_normal(80)
        measured = exact + 0.01 * abs(exact) * np.sqrt(0.5) * noise
        bodies.append(
            {
                "kind": "frequencyResponse",
                "operatingPoint": [p],
                "frequenciesRadPerSecond": omega.tolist(),
                "response": {"re": measured.real.tolist(), "im": measured.imag.tolist()},
                "variance": ((0.01 * abs(exact)) ** 2).tolist(),
                "varianceDegreesOfFreedom": freedom,
            }
        )
    return bodies


@pytest.fixture(scope="module")
def stated(api: Api, plant: Json) -> Json:
    return api.post("/models/stated", {"plantId": plant["id"], "theta": [1.8, 64.0, 28.0, 1.0], "noiseVariance": 1.0})


def test_hum_between_the_harmonics_is_fitted(api: Api, plant: Json, stated: Json) -> None:
    record = HiddenPlant(0.0).records([0.0], level=10.0, seed=31)[0]
    time = 0.05 * np.arange(len(record["output"]))
    record["output"] = (np.array(record["output"]) + 0.02 * np.cos(2 * np.pi * 1.27 * time + 0.4)).tolist()
    quiet = HiddenPlant(0.0).records([0.5], level=10.0, seed=32)[0]
    made = [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in (quiet, record)]
    covariance = np.diag([1e-4] * 4).tolist()
    body = {"plantId": plant["id"], "theta": [1.8, 64.0, 28.0, 1.0], "noiseVariance": 1.0, "covariance": covariance}
    model = api.post("/models/stated", body)["id"]
    compared = api.made("/comparisons", {"modelId": model, "experimentIds": made})
    (found,) = compared["parts"][0]["disturbances"]
    assert found["experimentId"] == made[1]
    for name, unit, true in (("frequency", "RadPerSecond", 2 * np.pi * 1.27), ("amplitude", "", 0.02)):
        deviation = found[f"{name}Deviation{unit}"]
        assert abs(found[f"{name}{unit}"] - true) < 4 * deviation < 0.05 * true
    assert found["phaseRad"] == pytest.approx(0.4, abs=0.2)
    assert found["pValue"] < 1e-3


def test_frequency_responses_alone(api: Api, plant: Json, stated: Json) -> None:
    bodies = responses([-1.0, 0.0, 1.0], delay=0.01)
    measured = [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in bodies]
    found = api.made("/diagnoses", {"modelId": stated["id"], "experimentIds": measured, "domain": "mechanical"})
    status = {one["kind"]: one["status"] for one in found["visibility"]}
    assert status["cubic_stiffness"] == status["saturation"] == status["hum"] == "notJudged"
    assert status["delay"] == "visible"
    assert "inductance" not in status
    assert "delay" in found["announced"]
    body = {"effect": "delay", "experimentIds": measured[::2], "heldOutExperimentIds": measured[1:2]}
    grown = api.made(f"/models/{stated['id']}/extensions", body)
    amplitude, deviation = (grown["effects"][0][name][0][0] for name in ("coefficients", "standardDeviations"))
    assert abs(amplitude - 0.01) < 4 * deviation < 0.002
    assert grown["extension"]["after"]["heldOut"] < 0.5 * grown["extension"]["before"]["heldOut"]


def warm(points: list[float], temperatures: list[float]) -> list[Json]:
    """Frequency responses of the plant, whose stiffness grows by 0.4 a kelvin, with what was logged."""
    bodies = responses(points, delay=0.0)
    for body, p, t in zip(bodies, points, temperatures, strict=True):
        omega = np.array(body["frequenciesRadPerSecond"])
        known = 64.0 + 28.0 * p - omega**2 + 1.8j * omega
        measured = (np.array(body["response"]["re"]) + 1j * np.array(body["response"]["im"])) * known
        measured = measured / (known + 0.4 * (t - 300.0))
        body["response"] = {"re": measured.real.tolist(), "im": measured.imag.tolist()}
        body["loggedQuantities"] = [
            {"name": "temperature", "unit": "K", "value": t},
            {"name": "humidity", "value": 0.5 + 0.3 * np.cos(9 * t)},
        ]
    return bodies


def test_a_logged_quantity_on_which_the_plant_depends(api: Api, plant: Json, stated: Json) -> None:
    bodies = warm([-1.0, -0.5, 0.0, 0.5, 1.0, -0.2, 0.7], [300.0, 310.0, 296.0, 305.0, 299.0, 308.0, 294.0])
    measured = [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in bodies]
    kept = api.get(f"/experiments/{measured[1]}")["loggedQuantities"]
    assert kept == [{"unit": "", **one} for one in bodies[1]["loggedQuantities"]]
    fitted, held_out = measured[:5], measured[5:]
    found = api.made("/diagnoses", {"modelId": stated["id"], "experimentIds": fitted})
    first = found["ranking"][0]
    assert (first["kind"], first["quantity"]) == ("second_variable", "temperature [K]")
    assert {one["quantity"] for one in found["visibility"] if one["kind"] == "second_variable"} == {
        "temperature [K]",
        "humidity",
    }
    assert next(one for one in found["visibility"] if one["kind"] == "rate_dependence")["status"] == "invisible"
    body = {"effect": "second_variable", "quantity": "temperature", "experimentIds": fitted}
    grown = api.made(f"/models/{stated['id']}/extensions", {**body, "heldOutExperimentIds": held_out})
    (effect,) = grown["effects"]
    assert effect["quantity"] == "temperature [K]"
    deviation = effect["standardDeviations"][0][0]
    assert abs(effect["coefficients"][0][0] - 0.4) < 4 * deviation < 0.1
    assert grown["extension"]["after"]["heldOut"] < 0.3 * grown["extension"]["before"]["heldOut"]
    compared = api.made("/comparisons", {"modelId": grown["id"], "experimentIds": measured})
    assert all(part["lackOfFit"]["pValue"] > 1e-3 for part in compared["parts"])


def test_variances_of_too_few_degrees_of_freedom_are_a_problem_of_the_job(api: Api, plant: Json, stated: Json) -> None:
    body = {"plantId": plant["id"], **responses([0.0], delay=0.0, freedom=2.0)[0]}
    experiment = api.made("/experiments", body)["id"]
    with pytest.raises(JobFailedError) as failed:
        api.made("/diagnoses", {"modelId": stated["id"], "experimentIds": [experiment]})
    assert failed.value.problem["status"] == 422
    assert pointers(failed.value.problem) == ["/experimentIds"]


def test_an_effect_that_the_experiments_leave_no_room_for_is_a_problem_of_the_job(
    api: Api, stated: Json, fitted: list[str]
) -> None:
    body = {"effect": "quadratic_dependence", "experimentIds": fitted[2:4]}
    with pytest.raises(JobFailedError) as failed:
        api.made(f"/models/{stated['id']}/extensions", body)
    assert failed.value.problem["status"] == 422
    assert pointers(failed.value.problem) in (["/effect"], ["/experimentIds"])


def test_the_same_key_is_the_same_job(api: Api, model: Json, fitted: list[str]) -> None:
    body = {"modelId": model["id"], "experimentIds": fitted[:1]}
    jobs = [api.http.post("/comparisons", json=body, headers={"Idempotency-Key": "c1"}).json() for _ in range(2)]
    assert jobs[0]["id"] == jobs[1]["id"]
    other = api.http.post("/comparisons", json={**body, "meanValue": False}, headers={"Idempotency-Key": "c1"})
    assert api.problem(other)["status"] == 409
    assert api.finished(jobs[0])["result"]["kind"] == "comparisons"


def test_parameters_may_be_known_exactly(api: Api, plant: Json) -> None:
    """A stiffness that is 0.2 off is explained by a standard deviation of 0.4, and by nothing else."""
    record = HiddenPlant(0.0).records([0.4], level=10.0, seed=21)[0]
    experiment = api.made("/experiments", {"plantId": plant["id"], **record})["id"]
    body = {"plantId": plant["id"], "theta": [1.8, 64.2, 28.0, 1.0], "noiseVariance": 1.0}
    found = []
    for deviation in (0.4, 0.0):
        covariance = np.diag([0.0, deviation**2, 0.0, 0.0]).tolist()
        model = api.post("/models/stated", {**body, "covariance": covariance})
        compared = api.made("/comparisons", {"modelId": model["id"], "experimentIds": [experiment]})
        found.append(compared["parts"][0]["lackOfFit"])
    assert found[0]["pValue"] > 1e-3
    assert found[1]["pValue"] < 1e-6
    assert found[0]["statistic"] < found[1]["statistic"]
