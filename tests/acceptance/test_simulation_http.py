"""Models simulated along p(t) over HTTP, with bands that hold, and what is refused."""

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT
from tests.support import paper, responses, varying
from tests.support.api import Api, JobFailedError, Json, pointers


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", varying.TURBINE)


@pytest.fixture(scope="module")
def record(api: Api, plant: Json) -> str:
    return str(api.made("/experiments", varying.body(plant, varying.turbine(21)))["id"])


@pytest.fixture(scope="module")
def model(api: Api, plant: Json, record: str) -> Json:
    request = {"plantId": plant["id"], "experimentId": record, "estimator": {"kind": "periodic_likelihood"}}
    return api.made("/models/varying", request)


@pytest.fixture(scope="module")
def stated(api: Api) -> Json:
    plant = api.post("/plants", paper.PLANT)
    theta = [-0.9, 0.1, 10, -1, -0.7, 0.08]
    covariance = (1e-6 * np.eye(6)).tolist()
    body = {"plantId": plant["id"], "theta": theta, "noiseVariance": 0.5, "covariance": covariance}
    return api.post("/models/stated", body)


def simulated(api: Api, model: Json, excitation: Json) -> Json:
    return api.made(f"/models/{model['id']}/simulations", {"excitation": excitation})


def test_a_given_excitation_has_an_output_with_a_band_that_holds(api: Api, model: Json) -> None:
    g = np.random.default_rng(5)
    u, p = g.standard_normal((400, 1)), g.uniform(-1, 1, (400, 1))
    found = simulated(api, model, {"kind": "given", "inputs": u.T.tolist(), "scheduling": p.T.tolist()})
    assert (found["samples"], found["modelId"], found["notes"]) == (400, model["id"], [])
    assert found["ranges"][0]["maximum"] == p.max()
    data = api.get(f"/simulations/{found['id']}/data")
    truth = PLANT.simulate(u, p)[:, 0]
    y, low, high = (np.array(data[name][0]) for name in ("outputs", "lower95", "upper95"))
    deviation = (high - low) / 2 / 1.96
    assert np.sqrt(np.mean(deviation**2)) == pytest.approx(found["outputs"][0]["deviation"], rel=1e-3)
    assert 0.1 < np.sqrt(np.mean(((y - truth) / np.maximum(deviation, 1e-12))[1:] ** 2)) < 3
    assert np.mean((low <= truth) & (truth <= high)) > 0.3
    assert data["inputs"] == u.T.tolist()
    again = api.download(f"/simulations/{found['id']}/file", format="csv").decode().splitlines()
    assert again[0] == "time,u1,y1,p1,lower1,upper1"
    assert found["id"] in [one["id"] for one in api.get("/simulations")["items"]]


def test_an_experiment_can_be_played_again(api: Api, model: Json, record: str) -> None:
    found = simulated(api, model, {"kind": "experiment", "experimentId": record})
    y = np.array(api.get(f"/simulations/{found['id']}/data")["outputs"][0])
    measured = varying.turbine(21)[1][:, 0]
    assert np.std(measured - y) == pytest.approx(varying.NOISE, rel=0.1)
    assert found["experimentId"] == record


def test_a_rational_model_follows_p_and_says_what_it_leaves_out(api: Api, stated: Json) -> None:
    t = np.arange(300)
    p = 4 + 4 * np.sin(0.05 * t)
    found = simulated(api, stated, {"kind": "given", "inputs": [[1.0] * 300], "scheduling": [p.tolist()]})
    assert "held still" in found["notes"][0]
    y = np.array(api.get(f"/simulations/{found['id']}/data")["outputs"][0])
    expected = np.zeros(300)
    for i in range(1, 300):
        expected[i] = -(-0.9 + 0.1 * p[i]) * expected[i - 1] + (10 - p[i])
    assert np.allclose(y, expected)
    assert found["outputs"][0]["deviation"] > 0


def test_the_signals_of_a_design_can_be_tried_before_they_are_played(api: Api, stated: Json) -> None:
    plant = {"id": stated["plantId"]}
    design = api.made("/designs", {**paper.FIGURES[0].body(plant, stated), "samples": 500})
    signals = api.made(f"/designs/{design['id']}/signals", {"periods": 5})
    found = simulated(api, stated, {"kind": "signal", "signalsId": signals["id"], "index": 0})
    first = signals["signals"][0]
    assert found["samples"] == first["samples"]
    assert found["ranges"][0]["minimum"] == first["operatingPoint"][0]


def test_models_without_covariance_have_no_band(api: Api, plant: Json, record: str) -> None:
    request = {"plantId": plant["id"], "experimentId": record, "estimator": {"kind": "periodic_moesp"}}
    moesp = api.made("/models/varying", request)
    found = simulated(api, moesp, {"kind": "experiment", "experimentId": record})
    assert "deviation" not in found["outputs"][0]
    assert "no covariance" in found["notes"][0]
    assert "lower95" not in api.get(f"/simulations/{found['id']}/data")


BAD: dict[str, tuple[Json, str]] = {
    "scheduling out of range": ({"inputs": [[1.0, 2.0]], "scheduling": [[0.0, 1.5]]}, "/excitation/scheduling"),
    "two inputs": ({"inputs": [[1.0], [2.0]], "scheduling": [[0.0]]}, "/excitation/inputs"),
    "two variables": ({"inputs": [[1.0]], "scheduling": [[0.0], [0.0]]}, "/excitation/scheduling"),
    "unequal lengths": ({"inputs": [[1.0, 2.0]], "scheduling": [[0.0]]}, "/excitation/scheduling"),
    "ragged lists": ({"inputs": [[1.0, 2.0], [1.0]], "scheduling": [[0.0]]}, "/excitation/inputs"),
    "nothing": ({"inputs": [[]], "scheduling": [[]]}, "/excitation/inputs"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_excitation(api: Api, model: Json, name: str) -> None:
    given, pointer = BAD[name]
    problem = api.refused(f"/models/{model['id']}/simulations", {"excitation": {"kind": "given", **given}})
    assert (problem["status"], pointers(problem)) == (422, [pointer])


def test_what_cannot_be_simulated_says_why(api: Api, model: Json, stated: Json, record: str) -> None:
    path = f"/models/{stated['id']}/simulations"
    problem = api.refused(path, {"excitation": {"kind": "experiment", "experimentId": record}})
    assert pointers(problem) == ["/excitation/experimentId"]
    problem = api.refused(path, {"excitation": {"kind": "signal", "signalsId": "none"}})
    assert pointers(problem) == ["/excitation/signalsId"]
    continuous = api.post(
        "/plants",
        {
            **responses.PLANT,
            **{
                "inputs": None,
                "outputs": None,
                "coefficientBases": [],
                "input": {"name": "u"},
                "output": {"name": "y"},
            },
            "structure": {"timeDomain": "continuous", "na": 1, "nb": 0},
        },
    )
    other = api.post(
        "/models/stated", {"plantId": continuous["id"], "theta": [1.0, 0.1, 1.0, 0.1], "noiseVariance": 1.0}
    )
    given = {"kind": "given", "inputs": [[1.0]], "scheduling": [[1.0]]}
    assert pointers(api.refused(f"/models/{other['id']}/simulations", {"excitation": given})) == ["/modelId"]


def test_a_model_that_is_unstable_along_p_is_no_number(api: Api, stated: Json) -> None:
    """Frozen it is stable everywhere; switched between the ends of a range of two poles it grows."""
    plant = {
        **varying.TURBINE,
        "structure": {"timeDomain": "discrete", "sampleTimeSeconds": 1, "na": 2, "nb": 0, "nk": 1},
    }
    plant |= {"input": plant.pop("inputs")[0], "output": plant.pop("outputs")[0]}
    kept = api.post("/plants", plant)
    theta = [0.0, 1.4, 0.95, 0.0, 1.0, 0.0]
    model = api.post("/models/stated", {"plantId": kept["id"], "theta": theta, "noiseVariance": 1.0})
    p = np.where(np.arange(4000) % 2, 1.0, -1.0)
    given = {"kind": "given", "inputs": [[1.0] * 4000], "scheduling": [p.tolist()]}
    with pytest.raises(JobFailedError) as failure:
        simulated(api, model, given)
    assert (failure.value.problem["status"], pointers(failure.value.problem)) == (422, ["/excitation/scheduling"])
    assert "unstable along" in failure.value.problem["detail"]
