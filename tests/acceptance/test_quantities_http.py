"""What input and output are decides what a force is: a speed is not taken for a position."""

from typing import Any

import pytest

from tests.support import flywheel
from tests.support.api import Api, Json, pointers

STATED = {"input": "torque", "output": "angularVelocity"}


def fitted(api: Api, **quantities: str) -> tuple[Json, list[str]]:
    plant = api.post("/plants", flywheel.plant(**quantities))
    made = [api.made("/experiments", {"plantId": plant["id"], **body})["id"] for body in flywheel.bodies()]
    request = {
        "plantId": plant["id"],
        "experimentIds": made,
        "spectralEstimator": {"kind": "periodic_average"},
        "localEstimator": {"kind": "rational_fit"},
        "lpvEstimator": {"kind": "joint_likelihood"},
    }
    return api.made("/models", request), made


@pytest.fixture(scope="module")
def stated(api: Api) -> tuple[Json, list[str]]:
    return fitted(api, **STATED)


def diagnosed(api: Api, model: Json, experiments: list[str], **more: Any) -> Json:
    return api.made("/diagnoses", {"modelId": model["id"], "experimentIds": experiments, **more})


def test_a_damper_is_found_behind_a_speed(api: Api, stated: tuple[Json, list[str]]) -> None:
    found = diagnosed(api, *stated)
    assert (found["inputQuantity"], found["outputQuantity"]) == ("torque", "angularVelocity")
    best = found["ranking"][0]
    assert found["announced"] == ["cubic_damping"]
    assert not best.get("reading")
    effect = best["evidence"]["effect"]
    (size,), (deviation,) = effect["coefficients"][0], effect["standardDeviations"][0]
    assert size == pytest.approx(flywheel.CUBE, abs=4 * deviation)
    assert deviation < 0.02 * flywheel.CUBE


def test_without_quantities_both_names_are_said(api: Api) -> None:
    found = diagnosed(api, *fitted(api))
    assert "outputQuantity" not in found
    best = found["ranking"][0]
    assert best["kind"] in ("cubic_stiffness", "cubic_damping")
    assert "cubic stiffness if the output is a position" in best["reading"]
    assert "cubic damping if the output is a speed" in best["reading"]


def test_a_version_and_a_staircase_see_the_quantity(api: Api, stated: tuple[Json, list[str]]) -> None:
    model, experiments = stated
    grown = api.made(f"/models/{model['id']}/extensions", {"effect": "cubic_damping", "experimentIds": experiments})
    (effect,) = grown["effects"]
    assert {one["name"]: one["value"] for one in effect["parameters"]}["order"] == 1
    assert grown["extension"]["after"]["fitted"] < 0.01
    steps = api.made(f"/models/{model['id']}/staircases", {"experimentIds": experiments})["steps"]
    assert [one.get("added") for one in steps] == [None, "cubic_damping"]


def test_records_without_a_period_show_forces_too(api: Api, stated: tuple[Json, list[str]]) -> None:
    model, _ = stated
    bodies = [{**body, "plantId": model["plantId"], "inputHold": "bandLimited"} for body in flywheel.bodies()]
    made = [api.made("/experiments", {**one, "periodSamples": None})["id"] for one in bodies[::2]]
    cut = {name: bodies[0][name][:-100] for name in ("input", "output")}
    made.append(api.made("/experiments", {**bodies[0], **cut, "periodSamples": None})["id"])
    grown = api.made(f"/models/{model['id']}/extensions", {"effect": "cubic_damping", "experimentIds": made})
    assert grown["effects"][0]["coefficients"][0][0] == pytest.approx(flywheel.CUBE, rel=0.1)


@pytest.mark.parametrize("asked", [{"domain": "electrical"}, {"effects": ["saturating_inductor"]}])
def test_effects_of_another_domain_are_refused(api: Api, stated: tuple[Json, list[str]], asked: Json) -> None:
    model, experiments = stated
    problem = api.refused("/diagnoses", {"modelId": model["id"], "experimentIds": experiments, **asked})
    assert pointers(problem) == ["/domain" if "domain" in asked else "/effects/0"]
    assert "torque and angular velocity" in problem["errors"][0]["detail"]


@pytest.mark.parametrize(
    ("quantity", "advice"), [("velocity", "state angularVelocity"), ("position", "angularVelocity"), ("charge", "C")]
)
def test_a_unit_of_another_quantity_is_refused(api: Api, quantity: str, advice: str) -> None:
    problem = api.refused("/plants", flywheel.plant(output=quantity))
    assert pointers(problem) == ["/output/quantity"]
    assert advice in problem["errors"][0]["detail"]


def test_a_quantity_that_does_not_exist_is_refused(api: Api) -> None:
    assert pointers(api.refused("/plants", flywheel.plant(output="speed"))) == ["/output/quantity"]
