"""Experiments in which the scheduling varies, over HTTP: from a record to a model with its accuracy."""

import re

import numpy as np
import pytest

from app.files import csv_writer, mat_writer, npz_writer
from benchmarks.affine_plant import AffinePlant
from benchmarks.wind_turbine_plant import PLANT
from identification.along import simulate_along
from identification.models.model import Model
from identification.varying.stacks import StackSizes
from tests.support import varying
from tests.support.api import Api, Json
from tests.support.responses import complex_array

LIKELIHOOD: Json = {"kind": "periodic_likelihood"}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", varying.TURBINE)


@pytest.fixture(scope="module")
def records(api: Api, plant: Json) -> list[str]:
    """The record to fit, and one held out."""
    bodies = [varying.body(plant, varying.turbine(seed)) for seed in (1, 2)]
    return [api.made("/experiments", body)["id"] for body in bodies]


@pytest.fixture(scope="module")
def model(api: Api, plant: Json, records: list[str]) -> Json:
    return identified(api, plant, records, LIKELIHOOD)


def identified(api: Api, plant: Json, records: list[str], estimator: Json, **more: object) -> Json:
    request = {"plantId": plant["id"], "experimentId": records[0], "heldOutExperimentIds": records[1:]}
    return api.made("/models", {"kind": "varyingScheduling", **request, "estimator": estimator, **more})


def test_what_was_understood_of_a_record_is_said(api: Api, records: list[str]) -> None:
    experiment = api.get(f"/experiments/{records[0]}")
    assert (experiment["kind"], experiment.get("operatingPoint")) == ("varyingRecord", None)
    understood = experiment["understood"]
    assert (understood["periodSamples"], understood["periodDetected"]) == (varying.PERIOD, True)
    seen = understood["varying"]
    assert (seen["synchronised"], seen["reason"], seen["leftOverSamples"]) == (True, "", 0)
    assert (seen["inputPeriodSamples"], seen["schedulingPeriodSamples"]) == (varying.PERIOD, 10)
    assert seen["ranges"] == [{"name": "cosine", "unit": "1", "minimum": pytest.approx(-1), "maximum": 1}]
    assert seen["steadyPeriods"] + understood["transientPeriods"] == varying.PERIODS
    assert seen["noiseLevels"] == [pytest.approx(varying.NOISE, rel=0.05)]
    assert "99.9 %" in seen["transientRule"]


@pytest.mark.parametrize("file_format", ["csv", "npz", "mat"])
def test_files_hold_the_same(api: Api, plant: Json, records: list[str], file_format: str) -> None:
    content = api.download(f"/experiments/{records[0]}/file", format=file_format)
    again = api.uploaded(f"again.{file_format}", content, plantId=plant["id"])
    assert (again["kind"], again["source"], again["sampleTimeSeconds"]) == ("varyingRecord", file_format, 1.0)
    assert api.get(f"/experiments/{again['id']}/data") == api.get(f"/experiments/{records[0]}/data")


def test_columns_may_have_names_of_their_own(api: Api, plant: Json) -> None:
    u, y, p = (signal[:600, 0] for signal in varying.turbine())
    named = csv_writer.write({"time": np.arange(600.0), "Cosine": p, "input": u, "output": y})
    stated = csv_writer.write({"u": u, "y": y, "blade angle": p})
    matrix = npz_writer.write({"u": u[:, None], "y": y[:, None], "angle": p[:, None]})
    row = mat_writer.write({"u": u[None], "y": y[None], "p": p[None]})
    columns = {"plantId": plant["id"], "sampleTimeSeconds": 1.0}
    found = [
        api.uploaded("a.csv", named, plantId=plant["id"]),
        api.uploaded("a.csv", stated, **columns, schedulingColumns=["blade angle"]),
        api.uploaded("a.npz", matrix, **columns, schedulingColumns=["angle"]),
        api.uploaded("a.mat", row, **columns),
    ]
    data = [api.get(f"/experiments/{one['id']}/data") for one in found]
    assert all(one == data[0] for one in data)
    assert data[0]["scheduling"] == [p.tolist()]


def test_maximum_likelihood_finds_the_plant_within_its_covariance(model: Json) -> None:
    assert (model["outcome"]["status"], model["origin"]) == ("converged", "identified")
    assert model["tests"][0]["pValue"] > 1e-3
    found = model["varying"]
    assert found["steady"]["schedulingPeriodSamples"] == 10
    assert found["noiseSpectrum"]["source"] == "betweenHarmonics"
    assert found["noiseSpectrum"]["covariance"][0][0] == pytest.approx(varying.NOISE**2, rel=0.1)
    assert [fit["data"] for fit in found["fits"]] == ["fitted", "heldOut"]
    for seed, fit in zip((1, 2), found["fits"], strict=True):
        floor = varying.NOISE**2 / np.var(varying.turbine(seed)[1])
        assert fit["vafPercent"] == pytest.approx(100 * (1 - floor), abs=5 * floor)
        assert fit["bfrPercent"] == pytest.approx(100 * (1 - np.sqrt(floor)), abs=3)
    assert 0 < found["fits"][1]["outputDeviations"][0] < varying.NOISE
    constant, cosine = found["eigenvalues"]
    assert (constant["function"], cosine["function"]) == ("1", "cosine")
    truth = np.linalg.eigvals(PLANT.a[0])
    errors = np.sort_complex(complex_array(constant["eigenvalues"])) - np.sort_complex(truth)
    deviation = np.sqrt(np.array(constant["imaginaryVariances"]))
    assert np.all(abs(errors.imag) < 4 * deviation)
    assert np.all(deviation < 0.01)
    assert len(model["standardDeviations"]) == len(model["parameterNames"]) == 18
    assert model["parameterNames"][4] == "A[1](1,1)"


def test_its_frozen_response_has_a_band_that_holds(api: Api, model: Json) -> None:
    band = {"minimumRadPerSecond": 0.05, "maximumRadPerSecond": 3.0, "count": 40}
    found = api.get(f"/models/{model['id']}/frequency-response", operatingPoint=[0.6], **band)
    omega = np.array(found["frequenciesRadPerSecond"])
    truth = PLANT.frequency_response(np.array([[0.6]]), omega)[0, :, 0, 0]
    error = complex_array(found["response"]) - truth
    normalised = error.real / np.sqrt(found["realVariance"])
    assert 0.05 < np.sqrt(np.mean(normalised**2)) < 3
    assert np.all(np.array(found["magnitudeLower95"]) < np.array(found["magnitudeUpper95"]))
    poles = {one["operatingPoint"][0]: complex_array(one["poles"]) for one in model["poles"]}
    assert np.allclose(np.sort_complex(poles[0.0]), np.sort_complex(np.linalg.eigvals(PLANT.a[0])), atol=0.02)


def test_any_estimator_may_start_the_likelihood(api: Api, plant: Json, records: list[str], model: Json) -> None:
    moesp = {"kind": "periodic_moesp", "varyingOutput": False}
    alone = identified(api, plant, records, moesp)
    assert "covariance" not in alone
    assert "outputDeviations" not in alone["varying"]["fits"][1]
    assert alone["varying"]["eigenvalues"][0]["realVariances"] == [None, None]
    for estimator in (moesp, {"kind": "correlation_realisation", "refinement": False}):
        refined = identified(api, plant, records, estimator, refinement=LIKELIHOOD)
        assert refined["varying"]["startingOutcome"]
        found, expected = (
            np.sort_complex(complex_array(one["varying"]["eigenvalues"][0]["eigenvalues"])) for one in (refined, model)
        )
        assert np.allclose(found, expected, atol=1e-4)
        assert "covariance" in refined


@pytest.fixture(scope="module")
def cox(api: Api) -> tuple[Json, list[str]]:
    plant = api.post("/plants", varying.COX)
    signals = [varying.white(varying.cox_plant(), count, seed) for count, seed in ((1000, 1), (500, 2))]
    return plant, [api.made("/experiments", varying.body(plant, one))["id"] for one in signals]


def test_white_excitation_gives_a_model_with_several_inputs_and_outputs(api: Api, cox: tuple[Json, list[str]]) -> None:
    plant, records = cox
    experiment = api.get(f"/experiments/{records[0]}")
    assert "periodSamples" not in experiment["understood"]
    assert not experiment["understood"]["varying"]["synchronised"]
    assert "does not repeat itself" in experiment["understood"]["varying"]["reason"]
    free = {**varying.TURBINE["structure"], "order": None}
    found = identified(api, plant, records, {"kind": "correlation_realisation"}, structure=free)
    assert found["outcome"]["status"] == "converged"
    assert "order 2 was chosen" in found["outcome"]["advice"]
    assert (found["structure"]["order"], found["varying"]["warnings"], found["varying"].get("steady")) == (2, [], None)
    assert found["varying"]["noiseSpectrum"]["source"] == "residuals"
    assert np.allclose(np.diag(found["varying"]["noiseSpectrum"]["covariance"]), 0.02**2, rtol=0.15)
    assert all(fit["vafPercent"] > 99.9 for fit in found["varying"]["fits"])
    truth = varying.cox_plant()
    point, channel = [0.7, -0.4], {"outputNumber": 2, "inputNumber": 1}
    band = {"minimumRadPerSecond": 0.05, "maximumRadPerSecond": 3.0, "count": 20}
    response = api.get(f"/models/{found['id']}/frequency-response", operatingPoint=point, **band, **channel)
    omega = np.array(response["frequenciesRadPerSecond"])
    error = complex_array(response["response"]) - truth.frequency_response(np.array([point]), omega)[0, :, 1, 0]
    assert 0.05 < np.sqrt(np.mean(error.real**2 / np.array(response["realVariance"]))) < 3
    assert [one["function"] for one in found["varying"]["eigenvalues"]] == ["1", "speed", "load"]
    of_speed = complex_array(found["varying"]["eigenvalues"][1]["eigenvalues"])
    assert np.allclose(np.sort_complex(of_speed), np.sort_complex(np.linalg.eigvals(truth.a[2])), atol=0.05)


def test_what_was_kept_of_several_variables_is_the_model_again(api: Api, cox: tuple[Json, list[str]]) -> None:
    """Compared and simulated, its matrices and their covariance are in the order of the scheduling variables."""
    plant, records = cox
    model = identified(api, plant, records, {"kind": "correlation_realisation"})
    found = api.made("/comparisons", {"modelId": model["id"], "experimentIds": records})
    assert [one["vafPercent"] > 99.9 for one in found["experiments"]] == [True, True]
    for part in found["parts"]:
        assert part["noiseKnown"]
        assert "lackOfFit" not in part
        assert all(test["pValue"] > 1e-3 for test in part["simulationErrors"]), part
    maps = api.get(f"/comparisons/{found['id']}/maps")
    assert (
        [row["outputNumber"] for row in maps["rows"]] == [row["outputNumber"] for row in maps["timeRows"]] == [1, 2] * 2
    )
    excitation = {"kind": "experiment", "experimentId": records[1]}
    made = api.made(f"/models/{model['id']}/simulations", {"excitation": excitation})
    data = api.get(f"/simulations/{made['id']}/data")
    u, _, p = varying.white(varying.cox_plant(), 500, 2)
    error = np.array(data["outputs"]).T - varying.cox_plant().simulate(u, p)
    deviation = (np.array(data["upper95"]) - np.array(data["lower95"])).T / 2 / 1.96
    assert 0.2 < np.mean(error[5:] ** 2 / deviation[5:] ** 2) < 3
    expected = simulate_along(by_names(model), u, p).deviation
    assert np.allclose(deviation, expected, rtol=1e-3, atol=1e-9)


def by_names(model: Json) -> Model:
    """The model of a document, its parameters put in place by their names: B[0,1](1,2) is of the second variable."""
    sizes = StackSizes.of(varying.cox_plant().matrices)
    numbers = sizes.split(np.arange(sizes.size, dtype=float))
    places = []
    for name in model["parameterNames"]:
        letter, label, row, column = re.fullmatch(r"([ABCD])\[([01],[01])\]\((\d),(\d)\)", name).groups()
        function = {"0,0": 0, "1,0": 1, "0,1": 2}[label]
        places.append(int(numbers["ABCD".index(letter)][function, int(row) - 1, int(column) - 1]))
    plant = AffinePlant(*sizes.split(np.array(model["theta"])[np.argsort(places)]))
    first = plant.model()
    assert np.allclose(first.theta, np.array(model["theta"]))
    return plant.model(np.array(model["covariance"]))


def test_coloured_scheduling_breaks_an_assumption_and_is_said(api: Api, cox: tuple[Json, list[str]]) -> None:
    plant, _ = cox
    u, _, p = varying.white(varying.cox_plant(), 1000, 3)
    slow = 0.9 * p + np.roll(p, 1, axis=0)
    signals = varying.measured(varying.cox_plant(), u, slow / abs(slow).max(), 0.02, np.random.default_rng(3))
    record = api.made("/experiments", varying.body(plant, signals))["id"]
    found = identified(api, plant, [record], {"kind": "correlation_realisation"})
    assert any("scheduling is not white (A3)" in warning for warning in found["varying"]["warnings"])
    output_error = identified(
        api,
        plant,
        [record],
        {"kind": "correlation_realisation", "refinement": False},
        refinement={"kind": "output_error"},
    )
    assert output_error["varying"]["fits"][0]["vafPercent"] > 99.9


def test_a_plant_with_squares_needs_a_basis_with_squares(api: Api) -> None:
    """Both ends of the range are wrong by what is missing with 1 and p; with B-splines of degree 2 nothing is."""
    variables = [{"name": "height", "unit": "mm", "minimum": 2.0, "maximum": 4.0}]
    plant = api.post("/plants", {**varying.TURBINE, "schedulingVariables": variables})
    g = np.random.default_rng(7)
    u, q = np.tile(g.standard_normal(120), 12), np.tile(g.uniform(-1, 1, 10), 144)
    y, x = np.empty(len(u)), 0.0
    for t, (v, s) in enumerate(zip(u, q, strict=True)):
        y[t] = (1 + 0.3 * s * s) * x
        x = (0.4 + 0.3 * s * s) * x + (1 - 0.2 * s) * v
    signals = u[:, None], (y + 0.01 * g.standard_normal(len(y)))[:, None], (3 + q)[:, None]
    record = api.made("/experiments", varying.body(plant, signals, periodSamples=120))["id"]
    structure = {**varying.TURBINE["structure"], "order": 1}
    estimator = {"kind": "periodic_likelihood"}
    splines = {"factors": [{"kind": "b_spline", "degree": 2}]}
    found = identified(api, plant, [record], estimator, structure=structure, basis=splines)
    assert found["tests"][0]["pValue"] > 1e-3
    assert found["basis"]["factors"][0]["kind"] == "b_spline"
    assert [one["function"] for one in found["varying"]["eigenvalues"]] == ["[0]", "[1]", "[2]"]
    omega = np.linspace(0.1, 3.0, 12)
    band = {"minimumRadPerSecond": 0.1, "maximumRadPerSecond": 3.0, "count": 12, "spacing": "linear"}
    response = api.get(f"/models/{found['id']}/frequency-response", operatingPoint=[3.8], **band)
    omega = np.array(response["frequenciesRadPerSecond"])
    exact = (1 + 0.3 * 0.64) * (1 - 0.2 * 0.8) / (np.exp(1j * omega) - 0.4 - 0.3 * 0.64)
    error = complex_array(response["response"]) - exact
    assert np.all(abs(error.real) < 5 * np.sqrt(response["realVariance"]))
    affine = identified(api, plant, [record], estimator, structure=structure)
    assert affine["tests"][0]["pValue"] < 1e-9
    compared = api.made("/comparisons", {"modelId": found["id"], "experimentIds": [record]})
    assert compared["parts"][0]["lackOfFit"]["pValue"] > 1e-3
    problem = api.refused(
        "/models/varying",
        {
            "plantId": plant["id"],
            "experimentId": record,
            "estimator": estimator,
            "basis": {"factors": splines["factors"] * 2},
        },
    )
    assert problem["errors"][0]["pointer"] == "/basis"


def test_the_catalogue_has_the_estimators_with_their_options(api: Api) -> None:
    catalogue = api.get("/catalogue")
    kinds = {one["kind"]: one for one in catalogue["varyingEstimators"]}
    assert {"periodic_likelihood", "periodic_moesp", "correlation_realisation"} <= set(kinds)
    assert "output_error" not in kinds
    assert {"window", "regularisations"} <= {option["name"] for option in kinds["periodic_moesp"]["options"]}
    assert {"output_error", "periodic_likelihood"} <= {one["kind"] for one in catalogue["varyingRefinements"]}
