"""A plant is described by a form with a live picture, or made as an example by one click."""

from tests.support.api import Api
from tests.support.browser import Visit
from tests.support.server import Server


def test_a_plant_is_described_with_a_live_picture(visit: Visit, server: Server) -> None:
    page = visit.open("/plants/new")
    page.get_by_text("2 functions").wait_for()
    page.get_by_label("degree", exact=True).fill("3")
    page.get_by_text("4 functions").wait_for()
    page.get_by_label("functions", exact=True).select_option("b_spline")
    page.get_by_label("degree", exact=True).fill("-1")
    page.get_by_text("No picture yet").wait_for()
    visit.expect_refusal(422)
    page.get_by_label("degree", exact=True).fill("2")
    page.get_by_text("3 functions").wait_for()
    page.get_by_role("button", name="Keep this plant").click()
    page.locator(".field-problem").first.wait_for()
    visit.expect_refusal(422)
    assert page.evaluate("document.activeElement.dataset.pointer") == "/name"
    assert visit.violations() == []
    for pointer, text in {"/name": "crane", "/input/name": "force", "/input/unit": "N", "/output/name": "way"}.items():
        page.locator(f'[data-pointer="{pointer}"]').fill(text)
    page.locator('[data-pointer="/schedulingVariables/0/name"]').fill("length")
    page.get_by_label("output: quantity").select_option("angular velocity")
    page.locator('[data-pointer="/output/unit"]').fill("m/s")
    page.get_by_role("button", name="Keep this plant").click()
    page.get_by_text("m/s is no unit of angular velocity").first.wait_for()
    visit.expect_refusal(422)
    page.get_by_label("output: quantity").select_option("velocity")
    page.get_by_role("button", name="Give one coefficient a basis of its own").click()
    page.get_by_label("coefficient", exact=True).select_option("b0")
    page.get_by_role("button", name="Keep this plant").click()
    page.get_by_role("heading", name="crane").wait_for()
    visit.wait()
    page.get_by_text("way (m/s): velocity").wait_for()
    plant = Api(server.url).get(f"/plants/{page.url.rsplit('/', 1)[1]}")
    assert plant["output"]["quantity"] == "velocity"
    assert plant["parameterNames"] == ["a1[0]", "a1[1]", "a1[2]", "a2[0]", "a2[1]", "a2[2]", "b0[0]"]
    assert visit.violations() == []


def test_two_scheduling_variables_are_pictured_as_a_map(visit: Visit) -> None:
    page = visit.open("/plants/new")
    page.get_by_role("button", name="Add another variable").click()
    page.get_by_text("4 functions").wait_for()
    page.get_by_role("application").focus()
    page.keyboard.press("ArrowRight")
    assert "variable 1 = " in page.locator(".map-reading").inner_text()
    assert visit.violations() == []
    page.get_by_role("button", name="Remove variable 2").click()
    page.get_by_text("2 functions").wait_for()


def test_an_example_takes_one_click(visit: Visit) -> None:
    page = visit.open("/plants")
    page.get_by_role("button", name="Make an example").click()
    page.wait_for_url("**/plants/*")
    visit.wait()
    assert "experiments" in page.locator("#steps").inner_text()
    assert page.get_by_role("link", name="identify a model").count() == 1
    assert visit.violations() == []


def test_a_plant_that_is_not_there_is_told(visit: Visit) -> None:
    page = visit.open("/plants/none")
    assert "Not found" in page.get_by_role("alert").inner_text()
    visit.faults = [fault for fault in visit.faults if "404" not in fault]
