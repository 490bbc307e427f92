"""Designs about effects through HTTP: what must be seen, which of two effects it is, models that carry effects."""

import numpy as np
import pytest

from tests.support.api import Api, JobFailedError, Json, pointers
from tests.support.hidden_plant import PERIOD, PLANT, SAMPLE_TIME

POINTS = [-1.0, 0.0, 1.0]
THETA = [1.8, 64.0, 28.0, 1.0]
DELAY, SIGMA, LEVEL = 0.008, 0.05, 20.0


@pytest.fixture(scope="module")
def plant(api: Api) -> Json:
    return api.post("/plants", PLANT)


@pytest.fixture(scope="module")
def model(api: Api, plant: Json) -> Json:
    return api.post("/models/stated", {"plantId": plant["id"], "theta": THETA, "noiseVariance": SIGMA**2})


def delayed(p: float, seed: int) -> Json:
    """The body of a record of four periods of a plant without stiffening whose input comes late."""
    generator = np.random.default_rng(seed)
    spectrum = np.zeros(PERIOD // 2 + 1, dtype=complex)
    lines = np.arange(1, 100)
    spectrum[lines] = LEVEL * np.sqrt(2 / 99) * PERIOD / 2 * np.exp(2j * np.pi * generator.random(99))
    omega = 2 * np.pi * np.fft.rfftfreq(PERIOD, SAMPLE_TIME)
    response = np.exp(-1j * omega * DELAY) / (64.0 + 28.0 * p - omega**2 + 1.8j * omega)
    u, y = np.fft.irfft(spectrum), np.fft.irfft(spectrum * response)
    noisy = np.tile(y, 4) + SIGMA * generator.standard_normal(4 * PERIOD)
    return {
        "kind": "timeRecord",
        "operatingPoint": [p],
        "sampleTimeSeconds": SAMPLE_TIME,
        "input": np.tile(u, 4).tolist(),
        "output": noisy.tolist(),
        "periodSamples": PERIOD,
    }


@pytest.fixture(scope="module")
def experiments(api: Api, plant: Json) -> list[str]:
    bodies = [delayed(p, 10 + i) for i, p in enumerate(POINTS)]
    return [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in bodies]


@pytest.fixture(scope="module")
def diagnosis(api: Api, model: Json, experiments: list[str]) -> Json:
    body = {"modelId": model["id"], "experimentIds": experiments, "effects": ["delay", "lag", "cubic_stiffness"]}
    return api.made("/diagnoses", body)


@pytest.fixture(scope="module")
def detection(plant: Json, model: Json) -> Json:
    return {
        "plantId": plant["id"],
        "modelId": model["id"],
        "operatingPoints": {"kind": "grid", "points": [[p] for p in POINTS]},
        "targets": [{"kind": "effect_detection", "effect": "cubic_stiffness", "amplitude": 0.5}],
        "spectrumFamily": {"kind": "multisines", "samples": PERIOD, "levels": [2.0, 4.0, 8.0]},
        "samples": 64 * PERIOD,
        "sampleTimeSeconds": SAMPLE_TIME,
        "tolerance": 1e-3,
    }


def test_what_must_be_seen_is_designed_and_played(api: Api, detection: Json) -> None:
    design = api.made("/designs", detection)
    assert design["outcome"]["status"] == "converged"
    assert 0 <= design["gap"] <= 1e-3
    assert design["lowerBound"] <= design["leastEnergy"] <= design["totalEnergy"]
    (decision,) = design["decisions"]
    assert (decision["question"], decision["effect"], decision.get("against")) == ("detection", "cubic_stiffness", None)
    assert decision["expectedPower"] >= decision["askedPower"] == 0.9
    assert decision["expectedVariance"] == pytest.approx(0.5**2 / decision["noncentrality"])
    made = api.made(f"/designs/{design['id']}/signals", {})
    for signal, experiment in zip(made["signals"], design["experiments"], strict=True):
        spectrum = experiment["spectrum"]
        assert spectrum["kind"] == "multisine"
        assert signal["energy"] == pytest.approx(experiment["energy"])
        assert (signal["periodSamples"], signal["periods"]) == (PERIOD, spectrum["periods"])
        assert signal["energy"] == pytest.approx(spectrum["level"] ** 2 * PERIOD * spectrum["periods"])
        assert signal["energyElsewhere"] < 1e-9 * signal["energy"]
    with pytest.raises(JobFailedError, match="lower levels"):
        api.made(f"/designs/{design['id']}/signals", {"amplitudeLimit": 0.1})


def test_a_diagnosis_that_cannot_decide_offers_the_design_that_can(
    api: Api, diagnosis: Json, experiments: list[str]
) -> None:
    assert set(diagnosis["announced"]) == {"delay", "lag"}
    assert not diagnosis["confident"]
    offered = diagnosis["decidingDesign"]
    assert offered["priorExperimentIds"] == experiments
    assert offered["noiseVariance"] == pytest.approx(SIGMA**2, rel=0.1)
    assert max(offered["spectrumFamily"]["levels"]) == pytest.approx(LEVEL, rel=1e-3)
    design = api.made("/designs", offered)
    assert design["outcome"]["status"] == "converged"
    pairs = {(one["effect"], one["against"]) for one in design["decisions"]}
    assert pairs == {("delay", "lag"), ("lag", "delay")}
    for decision in design["decisions"]:
        assert decision["question"] == "discrimination"
        assert decision["expectedPower"] >= 0.9 - 1e-6
        assert 0 < decision["probabilityOfWeightAbove95"] < 1


def test_a_model_with_effects_is_designed_for(
    api: Api, plant: Json, model: Json, experiments: list[str], detection: Json
) -> None:
    body = {"effect": "delay", "experimentIds": experiments}
    extended = api.made(f"/models/{model['id']}/extensions", body)
    accuracy = {
        **detection,
        "modelId": extended["id"],
        "targets": [{"kind": "parameter_deviation", "standardDeviations": [0.02, 0.1, 0.1, 0.005]}],
        "spectrumFamily": {"kind": "lines", "samples": PERIOD},
    }
    found = api.made("/designs", accuracy)
    assert found["parameterNames"] == extended["jointParameterNames"]
    assert len(found["expectedCovariance"]) == 5
    assert np.all(np.array(found["expectedStandardDeviations"])[:4] <= [0.02001, 0.1001, 0.1001, 0.005001])
    less = api.made("/designs", {**accuracy, "usePriorInformation": True, "tolerance": 1e-2})
    assert less["totalEnergy"] < found["totalEnergy"]
    seen = api.made("/designs", {**detection, "modelId": extended["id"]})
    assert len(seen["parameterNames"]) == 5
    assert seen["decisions"][0]["expectedPower"] >= 0.9


def test_bad_input(api: Api, detection: Json, experiments: list[str]) -> None:
    target = detection["targets"][0]
    for changes, pointer in (
        ({"targets": [{**target, "effect": "gremlins"}]}, "/targets/0"),
        ({"targets": [{**target, "power": 2.0}]}, "/targets/0"),
        ({"targets": [{**target, "effect": "resonance"}]}, "/targets/0"),
        ({"targets": [{"kind": "effect_discrimination", "effect": "delay", "against": "delay"}]}, "/targets/0"),
        ({"spectrumFamily": {"kind": "multisines", "samples": PERIOD, "levels": []}}, "/spectrumFamily"),
        ({"priorExperimentIds": ["nothing"]}, "/priorExperimentIds/0"),
        ({"priorExperimentIds": experiments, "usePriorInformation": True}, "/usePriorInformation"),
        ({"noiseVariance": -1.0}, "/noiseVariance"),
    ):
        problem = api.refused("/designs", {**detection, **changes})
        assert problem["status"] == 422
        assert any(one.startswith(pointer) for one in pointers(problem)), (changes, problem)


def test_bad_input_that_a_job_finds(api: Api, detection: Json) -> None:
    unknown = {"kind": "effect_discrimination", "effect": "delay", "against": "lag"}
    for changes, pointer in (
        ({"targets": [unknown]}, "/targets"),
        ({"spectrumFamily": {"kind": "lines", "samples": PERIOD}}, "/spectrumFamily"),
        ({"samples": PERIOD}, "/samples"),
        ({"operatingPoints": {"kind": "box", "minimum": [-1.0], "maximum": [1.0]}}, "/operatingPoints"),
        ({"targets": [{**detection["targets"][0], "effect": "gain_drift"}]}, "/targets"),
    ):
        with pytest.raises(JobFailedError) as failed:
            api.made("/designs", {**detection, **changes})
        assert failed.value.problem["status"] == 422, failed.value.problem
        assert pointers(failed.value.problem) == [pointer]
