"""Requests of comparisons, diagnoses and extensions that cannot be answered: refused at the field that is wrong."""

import copy
import json
from dataclasses import dataclass
from typing import Any

import pytest
from fastapi.testclient import TestClient

from app.container import Container
from tests.support.api import pointers
from tests.support.hidden_plant import PLANT

Json = dict[str, Any]
THETA = [1.8, 64.0, 28.0, 1.0]
DISCRETE = {"timeDomain": "discrete", "sampleTimeSeconds": 0.1, "na": 1, "nb": 0, "nk": 1}
UNKNOWN = "0" * 32


@dataclass
class Bench:
    """A plant with a stated model, and experiments that stand in the store without a job having looked at them."""

    client: TestClient
    container: Container

    def plant(self, **changes: Any) -> str:
        return str(self._made("/v1/plants", {**PLANT, **changes})["id"])

    def model(self, plant: str, theta: list[float] = THETA, **more: Any) -> Json:
        return self._made("/v1/models/stated", {"plantId": plant, "theta": theta, "noiseVariance": 0.1, **more})

    def _made(self, path: str, body: Json) -> Json:
        answer = self.client.post(path, json=body)
        assert answer.status_code == 201, answer.text
        made: Json = answer.json()
        return made

    def experiment(
        self,
        plant: str,
        kind: str = "timeRecord",
        periods: int | None = 4,
        step: float | None = 0.05,
        logged: tuple[tuple[str, str], ...] = (),
    ) -> str:
        document = {
            "plantId": plant,
            "operatingPoint": [0.0],
            "softwareVersion": "0",
            "kind": kind,
            "sampleTimeSeconds": step,
            "varianceKnown": False,
            "varianceDegreesOfFreedom": None,
            "source": "json",
            "loggedQuantities": [{"name": name, "unit": unit, "value": 1.0} for name, unit in logged],
            "understood": {"frequencyCount": 3, "periods": periods, "warnings": []},
        }
        return self.container.resources.add("experiments", document, plant).id

    def refused(self, path: str, body: Json) -> list[str]:
        """The fields that the problem points to."""
        answer = self.client.post(path, json=body)
        assert answer.status_code == 422, answer.text
        assert answer.headers["content-type"].startswith("application/problem+json")
        problem = answer.json()
        assert all(error["detail"] for error in problem["errors"])
        assert self.client.get("/v1/jobs").json()["items"] == []
        return pointers(problem)


@pytest.fixture
def bench(client: TestClient, container: Container) -> Bench:
    return Bench(client, container)


@pytest.fixture
def plant(bench: Bench) -> str:
    return bench.plant()


@pytest.fixture
def known(bench: Bench, plant: str) -> str:
    """A model with a covariance."""
    covariance = [[0.01 if i == j else 0.0 for j in range(4)] for i in range(4)]
    return str(bench.model(plant, covariance=covariance)["id"])


def test_experiments_of_another_plant_are_refused(bench: Bench, plant: str, known: str) -> None:
    own, foreign = bench.experiment(plant), bench.experiment(bench.plant(input={"name": "force", "unit": "kN"}))
    both = {"experimentIds": [own, foreign]}
    assert bench.refused("/v1/comparisons", {"modelId": known, **both}) == ["/experimentIds/1"]
    assert bench.refused("/v1/diagnoses", {"modelId": known, **both}) == ["/experimentIds/1"]
    path = f"/v1/models/{known}/extensions"
    assert bench.refused(path, {"effect": "delay", **both}) == ["/experimentIds/1"]
    held_out = {"effect": "delay", "experimentIds": [own], "heldOutExperimentIds": [foreign]}
    assert bench.refused(path, held_out) == ["/heldOutExperimentIds/0"]


def test_data_of_another_sampling_are_refused(bench: Bench) -> None:
    plant = bench.plant(structure=DISCRETE, coefficientBases=[])
    model = bench.model(plant, [-0.5, 1.0])["id"]
    same, other = bench.experiment(plant, step=0.1), bench.experiment(plant, step=0.2)
    continuous = bench.experiment(plant, "frequencyResponse", None, None)
    for wrong in (other, continuous):
        body = {"modelId": model, "experimentIds": [same, wrong]}
        assert bench.refused("/v1/comparisons", body) == ["/experimentIds/1"]
        assert bench.refused("/v1/diagnoses", body) == ["/experimentIds/1"]


def test_a_model_without_covariance_is_not_held_against_new_data(bench: Bench, plant: str, known: str) -> None:
    model, experiments = bench.model(plant)["id"], [bench.experiment(plant)]
    assert bench.refused("/v1/comparisons", {"modelId": model, "experimentIds": experiments}) == ["/modelId"]
    answer = bench.client.post("/v1/comparisons", json={"modelId": known, "experimentIds": experiments})
    assert answer.status_code == 202, answer.text


def test_an_operating_point_out_of_range_never_becomes_an_experiment(bench: Bench, plant: str) -> None:
    record = {"kind": "timeRecord", "sampleTimeSeconds": 0.05, "input": [0.0, 1.0, 0.0], "output": [0.0, 1.0, 0.0]}
    assert bench.refused("/v1/experiments", {"plantId": plant, "operatingPoint": [1.5], **record}) == [
        "/operatingPoint"
    ]


def test_effects_on_signals_need_records(bench: Bench, plant: str, known: str) -> None:
    experiments = [bench.experiment(plant), bench.experiment(plant, "frequencyResponse", None)]
    body = {"modelId": known, "experimentIds": experiments, "effects": ["delay", "cubic_stiffness"]}
    assert bench.refused("/v1/diagnoses", body) == ["/effects/1"]
    path = f"/v1/models/{known}/extensions"
    assert bench.refused(path, {"effect": "cubic_stiffness", "experimentIds": experiments}) == ["/effect"]
    held_out = {"experimentIds": experiments[:1], "heldOutExperimentIds": experiments[1:]}
    assert bench.refused(path, {"effect": "cubic_stiffness", **held_out}) == ["/effect"]


def test_effects_that_are_unknown_or_cannot_be_judged_are_refused(bench: Bench, plant: str, known: str) -> None:
    body = {"modelId": known, "experimentIds": [bench.experiment(plant)]}
    assert bench.refused("/v1/diagnoses", {**body, "effects": ["delay", "magic"]}) == ["/effects/1"]
    assert bench.refused("/v1/diagnoses", {**body, "effects": ["second_variable"]}) == ["/effects/0"]
    assert bench.refused("/v1/diagnoses", {**body, "effects": ["delay", "delay"]}) == ["/effects"]
    assert bench.refused("/v1/diagnoses", {**body, "effects": []}) == ["/effects"]
    ids = {"experimentIds": body["experimentIds"]}
    assert bench.refused(f"/v1/models/{known}/extensions", {**ids, "effect": "magic"}) == ["/effect"]


def test_logged_quantities_are_those_of_all_experiments_in_one_unit(bench: Bench, plant: str, known: str) -> None:
    warm, both = (("temperature", "K"),), (("temperature", "K"), ("humidity", "1"))
    k, celsius = bench.experiment(plant, logged=warm), bench.experiment(plant, logged=(("temperature", "°C"),))
    k2, k3 = bench.experiment(plant, logged=both), bench.experiment(plant, logged=both)
    asked = {"modelId": known, "effects": ["second_variable"]}
    for others in ([k, celsius], [k, bench.experiment(plant)]):
        assert bench.refused("/v1/diagnoses", {**asked, "experimentIds": others}) == ["/effects/0"]
    path = f"/v1/models/{known}/extensions"
    for chosen in ({}, {"quantity": "pressure"}):
        body = {"effect": "second_variable", "experimentIds": [k2, k3], **chosen}
        assert bench.refused(path, body) == ["/quantity"]
    body = {"effect": "delay", "experimentIds": [k2], "quantity": "humidity"}
    assert bench.refused(path, body) == ["/quantity"]
    for accepted in ({"experimentIds": [k, k2]}, {"experimentIds": [k2, k3], "quantity": "humidity"}):
        answer = bench.client.post(path, json={"effect": "second_variable", **accepted})
        assert answer.status_code == 202, answer.text


def test_a_model_of_a_logged_quantity_is_held_against_experiments_that_state_it(bench: Bench, plant: str) -> None:
    row = bench.container.resources.get("models", bench.model(plant)["id"])
    effect = {"kind": "second_variable", "title": "", "place": "", "unit": "", "amplitudeDegree": 0}
    effect |= {"coefficients": [[1.0]], "standardDeviations": None, "parameters": [], "quantity": "temperature [K]"}
    document = {**copy.deepcopy(row.document), "effects": [effect]}
    model = bench.container.resources.add("models", document, plant).id
    right = bench.experiment(plant, logged=(("temperature", "K"),))
    wrong = bench.experiment(plant, logged=(("temperature", "°C"),))
    both = {"modelId": model, "experimentIds": [right, wrong]}
    assert bench.refused("/v1/comparisons", both) == ["/experimentIds/1"]
    assert bench.refused("/v1/diagnoses", both) == ["/experimentIds/1"]
    body = {"effect": "delay", "experimentIds": [right], "heldOutExperimentIds": [wrong]}
    assert bench.refused(f"/v1/models/{model}/extensions", body) == ["/heldOutExperimentIds/0"]


@pytest.mark.parametrize(
    ("logged", "where"),
    [
        ([{"name": "t", "value": 1.0}, {"name": "t", "value": 2.0}], "/loggedQuantities"),
        ([{"name": "", "value": 1.0}], "/loggedQuantities/0/name"),
        ([{"name": "t", "value": "warm"}], "/loggedQuantities/0/value"),
        ([{"name": "t"}], "/loggedQuantities/0/value"),
        ("[", "/loggedQuantities"),
        ("[" * 100_000, "/loggedQuantities"),
        ({"name": "t", "value": 1.0}, "/loggedQuantities"),
    ],
)
def test_logged_quantities_are_named_once_and_have_a_value(bench: Bench, plant: str, logged: Any, where: str) -> None:
    record = {"sampleTimeSeconds": 0.05, "input": [0.0, 1.0, 0.0], "output": [0.0, 1.0, 0.0]}
    body = {"plantId": plant, "kind": "timeRecord", "operatingPoint": [0.0], **record, "loggedQuantities": logged}
    assert [one.removeprefix("/timeRecord") for one in bench.refused("/v1/experiments", body)] == [where]
    form = {"plantId": plant, "operatingPoint": "0.0"}
    form["loggedQuantities"] = logged if isinstance(logged, str) else json.dumps(logged)
    answer = bench.client.post("/v1/experiments/files", data=form, files={"file": ("a.csv", b"time,input,output\n")})
    assert answer.status_code == 422
    assert pointers(answer.json()) == [where]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ('[{"name": "t", "value": NaN}]', "/loggedQuantities/0/value"),
        ('[{"name": "t", "value": 1e999}]', "/loggedQuantities/0/value"),
        ('[{"name": "\\ud800", "value": 1}]', "/loggedQuantities/0/name"),
    ],
)
def test_numbers_and_texts_in_a_form_are_those_of_json(bench: Bench, plant: str, text: str, where: str) -> None:
    form = {"plantId": plant, "operatingPoint": "0.0", "loggedQuantities": text}
    answer = bench.client.post("/v1/experiments/files", data=form, files={"file": ("a.csv", b"time,input,output\n")})
    assert answer.status_code == 422
    assert pointers(answer.json()) == [where]


def test_a_diagnosis_needs_one_source(bench: Bench, plant: str, known: str) -> None:
    experiments = [bench.experiment(plant)]
    assert bench.refused("/v1/diagnoses", {"experimentIds": experiments}) == [""]
    assert bench.refused("/v1/diagnoses", {"modelId": known}) == [""]
    both = {"modelId": known, "comparisonId": UNKNOWN, "experimentIds": experiments}
    assert bench.refused("/v1/diagnoses", both) == [""]
    narrowed = {"modelId": known, "experimentIds": experiments, "effects": ["delay"], "domain": "mechanical"}
    assert bench.refused("/v1/diagnoses", narrowed) == [""]


def test_what_is_named_must_be_there(bench: Bench, plant: str, known: str) -> None:
    own = [bench.experiment(plant)]
    assert bench.refused("/v1/comparisons", {"modelId": UNKNOWN, "experimentIds": own}) == ["/modelId"]
    assert bench.refused("/v1/comparisons", {"modelId": known, "experimentIds": [UNKNOWN]}) == ["/experimentIds/0"]
    assert bench.refused("/v1/comparisons", {"modelId": known, "experimentIds": own * 2}) == ["/experimentIds"]
    assert bench.refused("/v1/comparisons", {"modelId": known, "experimentIds": []}) == ["/experimentIds"]
    assert bench.refused("/v1/diagnoses", {"comparisonId": UNKNOWN}) == ["/comparisonId"]
    body = {"effect": "delay", "experimentIds": own}
    assert bench.refused(f"/v1/models/{known}/extensions", {**body, "diagnosisId": UNKNOWN}) == ["/diagnosisId"]
    assert bench.client.post(f"/v1/models/{UNKNOWN}/extensions", json=body).status_code == 404


def test_fitted_data_are_not_held_out(bench: Bench, plant: str, known: str) -> None:
    own = [bench.experiment(plant)]
    body = {"effect": "delay", "experimentIds": own, "heldOutExperimentIds": own}
    assert bench.refused(f"/v1/models/{known}/extensions", body) == ["/heldOutExperimentIds/0"]


def test_a_response_says_which_effects_it_cannot_hold(bench: Bench, plant: str) -> None:
    row = bench.container.resources.get("models", bench.model(plant)["id"])
    document = copy.deepcopy(row.document)
    document["origin"] = "extended"
    effect = {"kind": "cubic_stiffness", "title": "", "place": "", "unit": "", "amplitudeDegree": 0}
    effect |= {"coefficients": [[1.0]], "standardDeviations": None, "parameters": []}
    document["effects"] = [effect]
    model = bench.container.resources.add("models", document, plant).id
    query = {"operatingPoint": 0.0, "minimumRadPerSecond": 1.0, "maximumRadPerSecond": 2.0}
    found = bench.client.get(f"/v1/models/{model}/frequency-response", params=query).json()
    assert found["leftOutEffects"] == ["cubic_stiffness"]
    assert "magnitudeLower95" not in found


def test_the_catalogue_has_every_effect_with_its_unit_and_source(client: TestClient) -> None:
    effects = {entry["kind"]: entry for entry in client.get("/v1/catalogue").json()["effects"]}
    assert len(effects) >= 30
    assert all(one["unit"] and one["source"] and one["description"] and one["place"] for one in effects.values())
    assert effects["cubic_stiffness"]["needsRecords"]
    assert not effects["inductance"]["needsRecords"]
    assert effects["inductance"]["domain"] == "impedance"
    assert effects["inductance"]["sign"] == "positive"
    assert effects["resonance"]["parameters"][0]["quantity"] == "frequency"
