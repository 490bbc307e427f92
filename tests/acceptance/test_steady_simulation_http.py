"""Steady states of models with and without effects over HTTP, against integration, filters and formulas."""

import numpy as np
import pytest
from scipy.signal import lfilter

from tests.support import paper
from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.hidden_plant import PERIOD, PLANT, SAMPLE_TIME, HiddenPlant

CUBIC, OFFSET = 20.0, 0.3
THETA = [1.8, 64.0, 28.0, 1.0]
KNOWN = np.diag([1e-6] * 4).tolist()


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


@pytest.fixture(scope="module")
def stated(api: Api, plant: Json) -> Json:
    body = {"plantId": plant["id"], "theta": THETA, "noiseVariance": 1.0, "covariance": KNOWN}
    return api.post("/models/stated", body)


def shown(points: list[float], seed: int, noise: float) -> list[Json]:
    """Records of the plant with a stiffening spring and a sensor that is off."""
    bodies = HiddenPlant(CUBIC).records(points, 15.0, seed, noise)
    return [{**body, "output": (np.array(body["output"]) + OFFSET).tolist()} for body in bodies]


@pytest.fixture(scope="module")
def records(api: Api, plant: Json) -> list[str]:
    bodies = shown([-1.0, -0.3, 0.4, 1.0], 1, 0.01)
    return [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in bodies]


def extended(api: Api, model: Json, effect: str, experiments: list[str], **more: str) -> Json:
    return api.made(f"/models/{model['id']}/extensions", {"effect": effect, "experimentIds": experiments, **more})


@pytest.fixture(scope="module")
def model(api: Api, stated: Json, records: list[str]) -> Json:
    return extended(api, extended(api, stated, "sensor_offset", records), "cubic_stiffness", records)


def simulated(api: Api, model: Json, excitation: Json) -> tuple[Json, Json]:
    found = api.made(f"/models/{model['id']}/simulations", {"excitation": excitation})
    return found, api.get(f"/simulations/{found['id']}/data")


def periodic(u: list[float], *points: float, sample_time: float = SAMPLE_TIME) -> Json:
    where = [[point] for point in points]
    return {"kind": "periodic", "input": u, "sampleTimeSeconds": sample_time, "operatingPoints": where}


def test_effects_in_two_places_answer_a_new_input_at_new_points_as_the_plant_does(api: Api, model: Json) -> None:
    truth = shown([-0.7], 9, 0.0)[0]
    u = truth["input"][:PERIOD]
    found, data = simulated(api, model, periodic(u, -0.7, 0.7))
    assert (found["kind"], found["samples"], found["leftOutEffects"]) == ("steadyPeriod", PERIOD, [])
    assert [one["operatingPoint"] for one in found["outputs"]] == data["operatingPoints"] == [[-0.7], [0.7]]
    assert (found["ranges"][0]["minimum"], found["ranges"][0]["maximum"]) == (-0.7, 0.7)
    assert "not held constant" in found["notes"][0]
    wanted = np.array(truth["output"][:PERIOD])
    low, output, high = (np.array(data[name][0]) for name in ("lower95", "outputs", "upper95"))
    assert np.linalg.norm(output - wanted) < 0.01 * np.linalg.norm(wanted - OFFSET)
    deviation = (high - low) / 2 / 1.96
    assert found["outputs"][0]["deviation"] == pytest.approx(np.sqrt(np.mean(deviation**2)), rel=1e-3)
    assert 0.2 < np.sqrt(np.mean(((output - wanted) / deviation) ** 2)) < 3
    linear = np.fft.irfft(np.fft.rfft(u) * response(-0.7), PERIOD)
    assert np.linalg.norm(linear + OFFSET - wanted) > 0.1 * np.linalg.norm(wanted - OFFSET)
    lines = api.download(f"/simulations/{found['id']}/file", format="csv").decode().splitlines()
    assert lines[0] == "time,u1,y1,y2,lower1,lower2,upper1,upper2"
    assert data["scheduling"] == []


def response(p: float) -> np.ndarray:
    omega = 2 * np.pi * np.fft.rfftfreq(PERIOD, SAMPLE_TIME)
    return np.asarray(1 / (64.0 + 28.0 * p - omega**2 + 1.8j * omega))


def test_a_periodic_experiment_is_played_again(api: Api, model: Json, records: list[str]) -> None:
    found, data = simulated(api, model, {"kind": "periodicExperiment", "experimentId": records[1]})
    assert (found["experimentId"], data["operatingPoints"]) == (records[1], [[-0.3]])
    measured = np.array(shown([-1.0, -0.3, 0.4, 1.0], 1, 0.01)[1]["output"])
    error = measured - np.tile(data["outputs"][0], len(measured) // PERIOD)
    assert np.std(error) == pytest.approx(0.01 * np.std(measured), rel=0.05)
    lines = api.download(f"/simulations/{found['id']}/file", format="csv").decode().splitlines()
    assert (lines[0], len(lines)) == ("time,u1,y1,p1,lower1,upper1", PERIOD + 1)


@pytest.fixture(scope="module")
def designed(api: Api) -> tuple[Json, Json]:
    """A model in discrete time without covariance, and signals for it."""
    plant = api.post("/plants", paper.PLANT)
    model = api.post("/models/stated", {"plantId": plant["id"], "theta": paper.THETA, "noiseVariance": 0.5})
    body = {**paper.FIGURES[0].body(plant, model), "samples": 500, "operatingPoints": paper.only(0.0, 1.5, 8.0)}
    design = api.made("/designs", body)
    return model, api.made(f"/designs/{design['id']}/signals", {"method": "filtered_noise", "samples": 40})


def test_designed_signals_are_played_where_they_were_designed_for_or_elsewhere(
    api: Api, designed: tuple[Json, Json]
) -> None:
    model, signals = designed
    asked = {"kind": "periodicSignal", "signalsId": signals["id"], "index": 1}
    own = signals["signals"][1]["operatingPoint"][0]
    for more, points in (({}, [own]), ({"operatingPoints": [[2.0], [7.5]]}, [2.0, 7.5])):
        found, data = simulated(api, model, {**asked, **more})
        u = np.array(data["inputs"][0])
        assert found["samples"] == signals["signals"][1]["periodSamples"] == len(u)
        for p, output in zip(points, data["outputs"], strict=True):
            settled = lfilter([0, 10 - p], [1, -0.9 + 0.1 * p], np.tile(u, 50))[-len(u) :]
            np.testing.assert_allclose(output, settled, atol=1e-9)
        assert (data.get("lower95"), found["notes"]) == (None, ["The model has no covariance, so there is no band."])


def test_what_does_not_fit_the_model_is_refused(
    api: Api, model: Json, designed: tuple[Json, Json], records: list[str]
) -> None:
    other, signals = designed
    signal = {"kind": "periodicSignal", "signalsId": signals["id"]}
    again = {"kind": "periodicExperiment", "experimentId": records[0]}
    for who, excitation, pointer in (
        (model, signal, "/excitation/signalsId"),
        (other, {**signal, "index": 99}, "/excitation/index"),
        (other, {**signal, "signalsId": "none"}, "/excitation/signalsId"),
        (other, {**signal, "operatingPoints": [[9.0]]}, "/excitation/operatingPoints/0"),
        (other, again, "/excitation/experimentId"),
        (other, periodic([1.0, 2.0], 1.0), "/excitation/sampleTimeSeconds"),
    ):
        problem = api.refused(f"/models/{who['id']}/simulations", {"excitation": excitation})
        assert (problem["status"], pointers(problem)) == (422, [pointer])


def test_a_delay_in_continuous_time(api: Api, plant: Json) -> None:
    structure = {"timeDomain": "continuous", "na": 2, "nb": 0, "delay": True}
    late = api.post("/plants", {**PLANT, "structure": structure})
    body = {"plantId": late["id"], "theta": [*THETA, 0.12], "noiseVariance": 1.0}
    u = shown([0.0], 9, 0.0)[0]["input"][:PERIOD]
    _, data = simulated(api, api.post("/models/stated", body), periodic(u, 0.5))
    omega = 2 * np.pi * np.fft.rfftfreq(PERIOD, SAMPLE_TIME)
    wanted = np.fft.irfft(np.fft.rfft(u) * response(0.5) * np.exp(-0.12j * omega), PERIOD)
    np.testing.assert_allclose(data["outputs"][0], wanted, atol=1e-9)


def test_effects_of_single_measurements_are_left_out_and_named(api: Api, stated: Json, records: list[str]) -> None:
    drifting = extended(api, stated, "gain_drift", records)
    u = np.sin(2 * np.pi * np.arange(64) / 64).tolist()
    found, data = simulated(api, drifting, periodic(u, 0.0))
    (left_out,) = found["leftOutEffects"]
    assert (left_out["kind"], left_out["reason"].partition(",")[0]) == (
        "gain_drift",
        "it belongs to single measurements",
    )
    omega = 2 * np.pi / (64 * SAMPLE_TIME)
    c, k, _, b = drifting["theta"]
    wanted = b / (k - omega**2 + 1j * omega * c)
    np.testing.assert_allclose(data["outputs"][0], np.imag(wanted * np.exp(2j * np.pi * np.arange(64) / 64)), atol=1e-9)


@pytest.fixture(scope="module")
def warm(api: Api, plant: Json, stated: Json) -> tuple[Json, str]:
    """A model whose stiffness grows with a logged temperature, and a record in which none was logged."""
    experiments = []
    omega = np.linspace(1.0, 20.0, 40)
    noise = np.random.default_rng(4)
    for p, t in ((-1.0, 300.0), (-0.5, 310.0), (0.0, 296.0), (0.5, 305.0), (1.0, 299.0)):
        measured = 1 / (64.0 + 28.0 * p + 0.4 * (t - 300.0) - omega**2 + 1.8j * omega)
        measured = measured + 1e-6 * (noise.standard_normal(40) + 1j * noise.standard_normal(40))
        body = {"kind": "frequencyResponse", "operatingPoint": [p], "frequenciesRadPerSecond": omega.tolist()}
        body |= {"response": {"re": measured.real.tolist(), "im": measured.imag.tolist()}, "variance": [2e-12] * 40}
        logged = [{"name": "temperature", "unit": "K", "value": t}]
        body |= {"plantId": plant["id"], "loggedQuantities": logged}
        experiments.append(api.made("/experiments", body)["id"])
    record = HiddenPlant(0.0).records([0.5], 10.0, 3)[0]
    unlogged = api.made("/experiments", {"plantId": plant["id"], **record})["id"]
    return extended(api, stated, "second_variable", experiments, quantity="temperature"), unlogged


def test_a_logged_quantity_must_be_stated(api: Api, warm: tuple[Json, str]) -> None:
    model, record = warm
    u = np.sin(2 * np.pi * np.arange(64) / 64).tolist()
    omega = 2 * np.pi / (64 * SAMPLE_TIME)
    known = {"loggedQuantities": [{"name": "temperature", "unit": "K", "value": 320.0}]}
    found, data = simulated(api, model, periodic(u, 0.5) | known)
    wanted = 1 / (64.0 + 14.0 + 8.0 - omega**2 + 1.8j * omega)
    np.testing.assert_allclose(data["outputs"][0], np.imag(wanted * np.exp(2j * np.pi * np.arange(64) / 64)), atol=1e-5)
    assert found["notes"][0] == "temperature [K] is taken as 320."
    path = f"/models/{model['id']}/simulations"
    celsius = {"loggedQuantities": [{"name": "temperature", "unit": "°C", "value": 47.0}]}
    again = {"kind": "periodicExperiment", "experimentId": record}
    for excitation in (periodic(u, 0.5), periodic(u, 0.5) | celsius, again):
        problem = api.refused(path, {"excitation": excitation})
        assert pointers(problem) == ["/excitation/loggedQuantities"]
        assert "temperature [K]" in problem["detail"]
    simulated(api, model, again | known)


BAD: dict[str, tuple[Json, str]] = {
    "too short": ({"input": [1.0]}, "/excitation/input"),
    "too long": ({"input": [0.0] * 200_001}, "/excitation/input"),
    "too many": ({"input": [0.0] * 100_000, "operatingPoints": [[0.0]] * 11}, "/excitation/input"),
    "not a number": ({"input": [1.0, None]}, "/excitation/input/1"),
    "no sample time": ({"sampleTimeSeconds": 0.0}, "/excitation/sampleTimeSeconds"),
    "out of range": ({"operatingPoints": [[0.0], [1.5]]}, "/excitation/operatingPoints/1"),
    "two variables": ({"operatingPoints": [[0.0, 0.0]]}, "/excitation/operatingPoints/0"),
    "nowhere": ({"operatingPoints": []}, "/excitation/operatingPoints"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input(api: Api, model: Json, name: str) -> None:
    change, pointer = BAD[name]
    excitation = {**periodic([1.0, -1.0, 0.5], 0.0), **change}
    problem = api.refused(f"/models/{model['id']}/simulations", {"excitation": excitation})
    assert (problem["status"], pointers(problem)) == (422, [pointer])


def test_records_that_are_not_periodic_are_refused(api: Api, plant: Json, model: Json) -> None:
    g = np.random.default_rng(2)
    record = {"kind": "timeRecord", "sampleTimeSeconds": SAMPLE_TIME, "operatingPoint": [0.0], "plantId": plant["id"]}
    record |= {"input": g.standard_normal(100).tolist(), "output": g.standard_normal(100).tolist()}
    once = api.made("/experiments", record)["id"]
    asked = {"kind": "periodicExperiment", "experimentId": once}
    problem = api.refused(f"/models/{model['id']}/simulations", {"excitation": asked})
    assert pointers(problem) == ["/excitation/experimentId"]


def test_where_there_is_no_steady_state_the_job_says_so(api: Api, model: Json) -> None:
    u = (1e5 * np.random.default_rng(1).standard_normal(128)).tolist()
    with pytest.raises(JobFailedError) as failure:
        simulated(api, model, periodic(u, 0.0, 0.5))
    assert (failure.value.problem["status"], pointers(failure.value.problem)) == (422, ["/excitation/input"])
    assert "at the operating point (0) no steady state" in failure.value.problem["detail"]
