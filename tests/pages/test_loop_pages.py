"""Models, comparisons, diagnoses and versions: what is seen, clicked and read on their pages."""

import re
from pathlib import Path

import pytest

from tests.support.api import Api, Json
from tests.support.browser import Visit
from tests.support.hidden_plant import PLANT, HiddenPlant
from tests.support.server import Server

CUBIC, LEVEL = 6.0, 20.0
POINTS = [-1.0, 0.0, 1.0]
ESTIMATORS = {
    "localEstimator": {"kind": "rational_fit"},
    "lpvEstimator": {"kind": "generalised_least_squares"},
    "spectralEstimator": {"kind": "periodic_average"},
}


@pytest.fixture(scope="module")
def known(server: Server) -> Json:
    """Identifiers of a plant that hides a cubic spring, and of a model that lacks it, held against measurements."""
    api, hidden = Api(server.url), HiddenPlant(cubic=CUBIC)
    plant = api.post("/plants", PLANT)["id"]
    bodies = [*hidden.records(POINTS, LEVEL, 1), *hidden.records([-0.5, 0.5], LEVEL, 2)]
    measured = [api.made("/experiments", {**body, "plantId": plant})["id"] for body in bodies]
    fitted, held_out = measured[: len(POINTS)], measured[len(POINTS) :]
    model = api.made("/models", {"plantId": plant, "name": "without it", "experimentIds": fitted, **ESTIMATORS})["id"]
    comparison = api.made("/comparisons", {"modelId": model, "experimentIds": measured})["id"]
    effects = ["cubic_stiffness", "delay", "lag"]
    diagnosis = api.made("/diagnoses", {"comparisonId": comparison, "effects": effects})["id"]
    return {
        "plant": plant,
        "fitted": fitted,
        "heldOut": held_out,
        "model": model,
        "comparison": comparison,
        "diagnosis": diagnosis,
    }


def test_a_cell_shows_what_was_measured_there(visit: Visit, known: Json) -> None:
    page = visit.open(f"/plants/{known['plant']}/compare/{known['comparison']}")
    fitted, held_out = page.get_by_role("application").all()
    box = fitted.bounding_box()
    assert box is not None
    fitted.click(position={"x": box["width"] - 11, "y": 12})
    readings = page.locator(".map-reading").all_inner_texts()
    assert "preload = 1, " in readings[0]
    assert "preload = 0.5, " in readings[1]
    assert readings[0].split(" Hz")[0].split()[-1] == readings[1].split(" Hz")[0].split()[-1]
    page.get_by_role("heading", name=f"At {readings[0].split(' Hz')[0].split()[-1]} Hz").wait_for()
    titles = page.locator("#cell h3").all_inner_texts()
    assert titles == ["Fitted: preload = 1", "Held out: preload = 0.5"]
    held_out.press("ArrowDown")
    held_out.press("Enter")
    page.get_by_role("heading", name="Held out: preload = -0.5".replace("-", "−")).wait_for()
    page.locator("#cell figure").nth(2).wait_for()
    page.locator("#cell summary").first.click()
    page.locator("#cell table").first.get_by_role("row", name="measured").first.wait_for()
    visit.draw_all()
    page.locator('#cell .plot[class*="js-plotly-plot"]').nth(2).wait_for()


def test_axes_are_linked(visit: Visit, known: Json) -> None:
    page = visit.open(f"/plants/{known['plant']}/compare/{known['comparison']}")
    ranges = "[...document.querySelectorAll('#cell .js-plotly-plot')].slice(0, 2).map((one) => one.layout.xaxis.range)"
    page.locator("#cell .plot").first.scroll_into_view_if_needed()
    page.locator("#cell .js-plotly-plot").first.wait_for()
    page.evaluate("Plotly.relayout(document.querySelector('#cell .js-plotly-plot'), 'xaxis.range', [0, 0.5])")
    page.wait_for_function(f"({ranges}).every((range) => range[1] === 0.5)")


def test_a_refused_extension_says_so_at_its_field(visit: Visit, known: Json) -> None:
    page = visit.open(f"/plants/{known['plant']}/diagnose/{known['diagnosis']}")
    assert page.locator("#ranking li").first.locator("h3").inner_text().startswith("cubic stiffness")
    page.get_by_text("What an added effect is fitted to").click()
    page.get_by_role("group", name="Fit to").get_by_role("button", name="None").click()
    page.get_by_role("button", name="Add this effect: cubic stiffness").click()
    problem = page.get_by_role("group", name="Fit to").locator(".field-problem")
    problem.wait_for()
    assert "at least 1" in problem.inner_text()
    visit.expect_refusal(422)


def test_effects_are_added_until_noise_is_left(visit: Visit, known: Json, tmp_path: Path, server: Server) -> None:
    page = visit.open(f"/plants/{known['plant']}/diagnose/{known['diagnosis']}")
    page.get_by_role("button", name="Add effects until noise explains what is left").click()
    page.wait_for_url(re.compile(r"/history\?model=\w+$"))
    visit.wait()
    grown = Api(server.url).get(f"/models/{page.url.rpartition('=')[2]}")
    assert grown["extension"]["heldOutExperimentIds"] == known["heldOut"]
    after = 100 * grown["extension"]["after"]["heldOut"]
    assert f"→ {after:.3g} %" in page.locator("#headline").inner_text()
    assert page.locator("#pair h3").all_inner_texts() == ["1. without it", "2. With cubic stiffness"]
    stiffness = page.locator("#pair").get_by_role("row", name="cubic stiffness").last.inner_text()
    assert stiffness.split("\t")[1] == "–"
    with page.expect_download() as waiting:
        page.get_by_role("button", name="Download the report").click()
    waiting.value.save_as(tmp_path / "report.html")
    assert "cubic stiffness" in (tmp_path / "report.html").read_text()


def test_a_model_says_where_it_came_from(visit: Visit, known: Json, server: Server) -> None:
    model = Api(server.url).get(f"/models/{known['model']}")
    page = visit.open(f"/plants/{known['plant']}/models/{known['model']}")
    first = page.locator("#parameters tbody tr").first.inner_text()
    assert first.startswith(model["parameterNames"][0])
    assert float(first.split("± ")[1]) == pytest.approx(model["standardDeviations"][0], rel=0.05)
    assert "rational fit" in page.locator("#provenance").inner_text()
    page.get_by_text("Its 3 experiments").click()
    links = page.locator("#provenance details").get_by_role("link")
    links.nth(len(POINTS) - 1).wait_for()
    assert links.count() == len(POINTS)


def test_what_cannot_be_told_apart_is_decided_by_a_design(visit: Visit, server: Server) -> None:
    api = Api(server.url)
    example = api.made("/examples", {"hiddenEffect": "delay", "seed": 5})
    few = example["experimentIds"][1::4]
    model = api.made("/models", {"plantId": example["plantId"], "experimentIds": few, **ESTIMATORS})["id"]
    body = {"modelId": model, "experimentIds": few, "effects": ["delay", "lag"]}
    diagnosis = api.made("/diagnoses", body)
    assert diagnosis["announced"] == ["delay", "lag"]
    page = visit.open(f"/plants/{example['plantId']}/diagnose/{diagnosis['id']}")
    assert "cannot be told apart here: delay and first-order lag" in page.locator("#verdict").inner_text()
    page.get_by_role("button", name="Design the deciding experiment").click()
    page.wait_for_url(re.compile(r"/design/\w+$"))
    visit.wait()
    asked, expected = page.get_by_role("row", name="delay or lag?").get_by_role("cell").all_inner_texts()[:2]
    assert asked.startswith("90.0")
    assert float(expected.split()[0]) > 89.9
