"""Records about an operating level, over HTTP: the level is found, or taken as stated, and never taken for dynamics."""

import numpy as np
import pytest
from scipy import signal

from tests.support.api import Api, JobFailedError, Json

INPUT_LEVEL, OUTPUT_LEVEL = 10.0, 300.0
PLANT = {
    "name": "heated vessel",
    "input": {"name": "u"},
    "output": {"name": "y"},
    "schedulingVariables": [{"name": "p", "minimum": 0, "maximum": 1}],
    "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 1, "nb": 0, "nk": 1},
    "basis": {"factors": [{"kind": "polynomial", "degree": 1}]},
}
THETA = [-0.8, 0.1, 0.4, 0.0]


def body(plant: Json, point: float, **more: object) -> Json:
    g = np.random.default_rng(int(10 * point))
    u = np.tile(g.standard_normal(128), 6)
    y = signal.lfilter([0.0, 0.4], [1.0, -0.8 + 0.1 * point], u)[128:] + 0.02 * g.standard_normal(640)
    arrays = {"input": (u[128:] + INPUT_LEVEL).tolist(), "output": (y + OUTPUT_LEVEL).tolist()}
    stated = {"kind": "timeRecord", "plantId": plant["id"], "operatingPoint": [point], "sampleTimeSeconds": 1.0}
    return {**stated, **arrays, "periodSamples": 128, **more}


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


@pytest.mark.parametrize("levels", [{}, {"inputLevel": INPUT_LEVEL, "outputLevel": OUTPUT_LEVEL}])
@pytest.mark.parametrize("local", ["prediction_error", "rational_fit"])
def test_theta_is_within_its_deviations(api: Api, plant: Json, levels: Json, local: str) -> None:
    made = [api.made("/experiments", body(plant, p, **levels)) for p in (0.0, 0.5, 1.0)]
    request = {
        "plantId": plant["id"],
        "experimentIds": [one["id"] for one in made],
        "localEstimator": {"kind": local},
        "lpvEstimator": {"kind": "joint_likelihood"},
    }
    if local == "rational_fit":
        request["spectralEstimator"] = {"kind": "periodic_average"}
    model = api.made("/models", request)
    assert model["outcome"]["status"] == "converged"
    assert abs(np.array(model["theta"]) - THETA) == pytest.approx(0, abs=5 * max(model["standardDeviations"]))
    assert max(model["standardDeviations"]) < 0.01


def test_what_was_stated_is_kept(api: Api, plant: Json) -> None:
    stated = {"inputLevel": 10.0, "outputLevel": 300.0, "inputHold": "zeroOrder", "feedback": True}
    made = api.made("/experiments", body(plant, 0.0, **stated))
    assert {name: made[name] for name in stated} == stated


def test_a_response_has_no_levels(api: Api, plant: Json) -> None:
    content = b"frequencyHz,responseRe,responseIm\n0.1,1,0\n0.2,0.9,-0.1\n0.3,0.8,-0.2\n"
    with pytest.raises(JobFailedError, match="frequency response"):
        api.uploaded("response.csv", content, plantId=plant["id"], operatingPoint=[0.0], inputLevel=1.0)
