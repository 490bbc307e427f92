"""From accuracy in the user's terms to certified experiments, the trade, and signals to play."""

import json

import numpy as np
import pytest

from tests.support.api import Api, Json
from tests.support.browser import Visit
from tests.support.paper import DEVIATIONS, PLANT, THETA, prepared
from tests.support.server import Server


@pytest.fixture(scope="module")
def plant(server: Server) -> Json:
    return prepared(Api(server.url))[0]


def designed(visit: Visit, server: Server) -> Json:
    visit.page.get_by_role("button", name="Design the experiments").click()
    visit.page.get_by_role("heading", name="Signals to play").wait_for()
    visit.wait()
    return Api(server.url).get(f"/designs/{visit.page.url.rsplit('/', 1)[1]}")


def test_a_gain_within_two_per_cent_with_its_trade_and_signals(visit: Visit, server: Server, plant: Json) -> None:
    page = visit.open(f"/plants/{plant['id']}/design")
    for label, value in (("within (± %)", "2"), ("from (Hz)", "0.01"), ("to (Hz)", "0.1"), ("at values of p", "5")):
        page.get_by_label(label, exact=True).fill(value)
    assert visit.violations() == []
    design = designed(visit, server)
    target = design["request"]["targets"][0]
    assert target["standardDeviation"] == pytest.approx(0.02 / 1.96)
    assert target["minimumRadPerSecond"] == pytest.approx(2 * np.pi * 0.01)
    assert target["operatingPoints"] == [[0], [2], [4], [6], [8]]
    assert design["gap"] <= 1e-4
    assert "certified" in page.locator("#summary").inner_text()
    page.get_by_role("button", name="Compute the trade").click()
    page.get_by_text("Least energy over the deviations").wait_for()
    page.locator("#trade summary").click()
    rows = page.locator("#trade tbody tr")
    rows.nth(5).wait_for()
    energies = {float(row.split("\t")[0]): float(row.split("\t")[1]) for row in rows.all_inner_texts()}
    assert energies[2] == pytest.approx(energies[1] / 4, rel=0.01)
    page.get_by_role("button", name="Make signals").click()
    with page.expect_download() as saved:
        page.get_by_role("button", name="as csv").first.click()
    assert saved.value.suggested_filename.endswith("-0.csv")
    assert saved.value.path().read_text().startswith("time,input\n")
    assert visit.violations() == []


def test_deviations_of_the_parameters_from_a_first_guess(visit: Visit, server: Server) -> None:
    plant = Api(server.url).post("/plants", {**PLANT, "name": "to be guessed"})
    page = visit.open(f"/plants/{plant['id']}/design")
    page.get_by_label("know", exact=True).select_option("parameter_deviation")
    for name, deviation, value in zip(plant["parameterNames"], DEVIATIONS, THETA, strict=True):
        page.get_by_label(name, exact=True).first.fill(str(deviation))
        page.get_by_label(name, exact=True).last.fill(str(value))
    page.get_by_label("noise variance").fill("0.5")
    page.get_by_label("kind of spectra").select_option("fir")
    page.get_by_label("most energy at one point").fill("1000")
    design = designed(visit, server)
    assert design["totalEnergy"] == pytest.approx(3542.6, rel=1e-3)  # the paper, at most 1000 a point
    binds = page.get_by_role("region", name="What binds").inner_text()
    assert "limit of energy at p = 0" in binds.replace("\N{NO-BREAK SPACE}", " ")
    assert visit.violations() == []


def test_what_cannot_be_is_told_with_advice_and_at_the_field(visit: Visit, server: Server, plant: Json) -> None:
    page = visit.open(f"/plants/{plant['id']}/design")
    page.get_by_label("to (Hz)").fill("4")
    page.get_by_role("button", name="Design the experiments").click()
    page.get_by_text("the band ends above the Nyquist frequency").wait_for()
    page.locator("input[aria-invalid='true']").wait_for()
    assert page.get_by_label("to (Hz)").get_attribute("aria-invalid") == "true"
    page.get_by_label("to (Hz)").fill("0.1")
    page.get_by_label("most energy at one point").fill("1e-6")
    page.get_by_role("button", name="Design the experiments").click()
    page.get_by_text("No experiments within these limits").wait_for()
    page.wait_for_url("**/design/*")
    visit.wait()
    found = Api(server.url).get(f"/designs/{page.url.rsplit('/', 1)[1]}")
    assert found["outcome"]["advice"] in page.locator("#summary").inner_text(), json.dumps(found["outcome"])


def test_a_design_that_would_notice_a_delay(visit: Visit, server: Server, plant: Json) -> None:
    page = visit.open(f"/plants/{plant['id']}/design")
    page.get_by_label("know", exact=True).select_option("effect_detection")
    page.get_by_label("effect", exact=True).select_option("delay")
    page.get_by_label("of at least").fill("0.1")
    page.get_by_label("power (%)").fill("80")
    assert visit.violations() == []
    target = designed(visit, server)["request"]["targets"][0]
    assert (target["effect"], target["amplitude"], target["power"], target["level"]) == ("delay", 0.1, 0.8, 0.05)
    assert "see delay of size 0.100 with 80.0 % power" in page.locator("#summary").inner_text()
