"""A record in a loop with its reference, over HTTP: by JSON and by file, kept, and heeded by what is identified."""

import numpy as np
import pytest

from tests.support.api import Api, JobFailedError, Json
from tests.support.loops import SLOW, in_loop, late, looped, proportional

PLANT = {
    "name": "plant in a loop",
    "input": {"name": "u"},
    "output": {"name": "y"},
    "schedulingVariables": [{"name": "p", "minimum": 0, "maximum": 1}],
    "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1.0, "na": 1, "nb": 1, "nk": 0},
    "basis": {"factors": [{"kind": "polynomial", "degree": 0}]},
}
TRUTH = np.array([-0.95, 0.3, 0.5 - 0.95 * 0.3])


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


def signals() -> dict[str, np.ndarray]:
    """A plant that answers within the sample, under a controller that does not: without the reference who knows."""
    g = np.random.default_rng(1)
    r = g.standard_normal(2000)
    v = 0.1 * np.cumsum(g.standard_normal(2000)) / np.sqrt(1 + np.arange(2000))
    u, y = looped(r, v, late(0.5, 1), direct=0.3)
    return {"input": u, "output": y, "reference": r}


def identified(api: Api, plant: Json, experiment: Json) -> Json:
    request = {
        "plantId": plant["id"],
        "experimentIds": [experiment["id"]],
        "localEstimator": {"kind": "prediction_error"},
        "lpvEstimator": {"kind": "joint_likelihood"},
    }
    return api.made("/models", request)


def body(plant: Json, **more: object) -> Json:
    stated = {"kind": "timeRecord", "plantId": plant["id"], "operatingPoint": [0.5], "sampleTimeSeconds": 1.0}
    return {**stated, **{name: x.tolist() for name, x in signals().items()}, **more}


def test_by_json_and_by_file(api: Api, plant: Json) -> None:
    made = [api.made("/experiments", body(plant, feedback=True))]
    columns = signals()
    lines = [
        "time,u,y,setpoint",
        *(
            f"{t},{u!r},{y!r},{r!r}"
            for t, (u, y, r) in enumerate(zip(*(x.tolist() for x in columns.values()), strict=True))
        ),
    ]
    made.append(api.uploaded("loop.csv", "\n".join(lines).encode(), plantId=plant["id"], operatingPoint="0.5"))
    assert all(one["feedback"] for one in made)
    assert any("reference of a loop" in text for text in made[1]["understood"]["warnings"])
    for one in made:
        model = identified(api, plant, one)
        assert abs(np.array(model["theta"]) - TRUTH) == pytest.approx(0, abs=4 * max(model["standardDeviations"]))


def test_without_it_a_loop_without_a_delay_cannot_be_judged(api: Api, plant: Json) -> None:
    stated = body(plant, feedback=True)
    del stated["reference"]
    made = api.made("/experiments", stated)
    with pytest.raises(JobFailedError, match="no delay"):
        identified(api, plant, made)


def test_a_reference_without_feedback_is_refused(api: Api, plant: Json) -> None:
    assert api.refused("/experiments", body(plant))["errors"][0]["pointer"] == "/reference"


def test_an_upload_says_that_a_controller_seems_to_have_acted(api: Api, plant: Json) -> None:
    record = in_loop(1, SLOW, proportional(1.0), 4000)
    stated = body(plant, input=record.input.tolist(), output=record.output.tolist())
    del stated["reference"]
    assert any("controller" in text for text in api.made("/experiments", stated)["understood"]["warnings"])
