"""A motor in the coefficients of physics walks the loop over HTTP, from records to designs and simulations."""

import numpy as np
import pytest
from scipy import signal

from tests.support.api import Api, Json, pointers

STEP, PERIOD = 0.02, 256
PLANT: Json = {
    "name": "motor",
    "input": {"name": "current", "unit": "A"},
    "output": {"name": "speed", "unit": "rad/s"},
    "schedulingVariables": [{"name": "load", "unit": "kg", "minimum": 0, "maximum": 1}],
    "structure": {
        "timeDomain": "continuousPhysical",
        "denominator": [{"name": "J", "unit": "kg m2"}, {"name": "d", "unit": "N m s"}],
        "numerator": [{"name": "k", "unit": "N m/A", "fixedAt": 0.5}],
        "frequencyScaleRadPerSecond": 5,
    },
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
    "coefficientBases": [{"coefficient": "d", "basis": {"factors": [{"kind": "polynomial", "degree": 0}]}}],
}
THETA = [0.02, 0.05, 0.1]


def held_record(plant: Json, p: float, seed: int) -> Json:
    """The held current drives the motor through the exact recursion of its differential equation."""
    g = np.random.default_rng(seed)
    u = np.tile(g.standard_normal(PERIOD), 5)
    inertia = 0.02 + 0.05 * p
    pole = np.exp(-0.1 / inertia * STEP)
    y = signal.lfilter([0.0, 5.0 * (1 - pole)], [1.0, -pole], u)[PERIOD:] + 0.02 * g.standard_normal(4 * PERIOD)
    stated = {"kind": "timeRecord", "plantId": plant["id"], "operatingPoint": [p], "sampleTimeSeconds": STEP}
    how = {"periodSamples": PERIOD, "inputHold": "zeroOrder", "inputLevel": 0.0, "outputLevel": 0.0}
    return {**stated, **how, "input": u[PERIOD:].tolist(), "output": y.tolist()}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


@pytest.fixture(scope="module")
def experiments(api: Api, plant: Json) -> list[str]:
    return [api.made("/experiments", held_record(plant, p, i))["id"] for i, p in enumerate((0.0, 0.3, 0.7, 1.0))]


@pytest.fixture(scope="module")
def model(api: Api, plant: Json, experiments: list[str]) -> Json:
    chosen = {
        "spectralEstimator": {"kind": "periodic_average"},
        "localEstimator": {"kind": "rational_fit"},
        "lpvEstimator": {"kind": "joint_likelihood"},
    }
    return api.made("/models", {"plantId": plant["id"], "experimentIds": experiments, **chosen})


def test_the_parameters_are_those_of_physics(plant: Json, model: Json) -> None:
    assert plant["structure"]["denominator"][0]["name"] == "J"
    assert model["coefficientNames"] == ["J", "d"]
    error = np.array(model["theta"]) - THETA
    assert np.all(abs(error) < 5 * np.array(model["standardDeviations"]))
    assert np.all(np.array(model["standardDeviations"]) < 0.02 * np.array(THETA))
    assert all(test["pValue"] > 1e-4 for test in model["tests"] if "lack of fit" in test["name"])


def test_it_is_designed_for_played_compared_diagnosed_and_simulated(
    api: Api, plant: Json, model: Json, experiments: list[str]
) -> None:
    target = {"kind": "parameter_deviation", "standardDeviations": [2e-4, 4e-4, 1e-3]}
    grid = {"kind": "gridAxes", "axes": [{"minimum": 0, "maximum": 1, "count": 5}]}
    asked = {"plantId": plant["id"], "modelId": model["id"], "samples": PERIOD, "operatingPoints": grid}
    family = {"kind": "lines", "samples": PERIOD}
    design = api.made("/designs", {**asked, "sampleTimeSeconds": STEP, "targets": [target], "spectrumFamily": family})
    assert design["outcome"]["status"] == "converged"
    signals = api.made(f"/designs/{design['id']}/signals", {"periods": 4})
    assert signals["signals"]
    stated = {"modelId": model["id"], "experimentIds": experiments}
    comparison = api.made("/comparisons", stated)
    assert comparison["parts"][0]["lackOfFit"]["pValue"] > 1e-4
    diagnosis = api.made("/diagnoses", stated)
    assert not diagnosis["announced"]
    simulated = api.made(
        f"/models/{model['id']}/simulations",
        {"excitation": {"kind": "periodicExperiment", "experimentId": experiments[0]}},
    )
    assert simulated["id"]


@pytest.mark.parametrize("fixed", [None, 0.0])
def test_one_coefficient_must_be_known(api: Api, fixed: float | None) -> None:
    numerator = [{"name": "k"} if fixed is None else {"name": "k", "fixedAt": fixed}]
    problem = api.refused("/plants", {**PLANT, "structure": {**PLANT["structure"], "numerator": numerator}})
    assert pointers(problem) == ["/structure"]
    assert "fix exactly one" in str(problem)
