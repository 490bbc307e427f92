"""Delete, undo, restore, rename and describe by buttons; what stands on a thing is said before it goes."""

import pytest

from tests.support.api import Api, Json
from tests.support.browser import Visit
from tests.support.hidden_plant import PLANT, HiddenPlant
from tests.support.server import Server

MANAGE = ".manage > summary"


@pytest.fixture
def plant(server: Server) -> Json:
    return Api(server.url).post("/plants", {**PLANT, "name": "to be changed"})


@pytest.fixture
def experiments(server: Server, plant: Json) -> list[Json]:
    api = Api(server.url)
    bodies = HiddenPlant(0.0).records([-1.0, 0.0, 1.0], 1.0, seed=3)
    return [
        api.made("/experiments", {**body, "plantId": plant["id"], "name": f"run {i}"}) for i, body in enumerate(bodies)
    ]


def kept(server: Server, plant: Json) -> dict[str, str]:
    return {one["id"]: one["name"] for one in Api(server.url).get("/experiments", plantId=plant["id"])["items"]}


def test_an_experiment_is_deleted_and_the_click_is_undone(
    visit: Visit, server: Server, plant: Json, experiments: list[Json]
) -> None:
    before = kept(server, plant)
    page = visit.open(f"/plants/{plant['id']}/experiments/{experiments[1]['id']}")
    page.locator(MANAGE).click()
    page.get_by_text("Nothing stands on this experiment").wait_for()
    assert visit.violations() == []
    page.get_by_role("button", name="Delete this experiment").click()
    page.get_by_text("Deleted: run 1").wait_for()
    assert kept(server, plant) == {k: v for k, v in before.items() if v != "run 1"}
    visit.wait()
    assert visit.violations() == []
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("heading", name="run 1").wait_for()
    assert kept(server, plant) == before


def test_what_stands_on_a_plant_is_said_goes_with_it_and_comes_back(
    visit: Visit, server: Server, plant: Json, experiments: list[Json]
) -> None:
    page = visit.open(f"/plants/{plant['id']}")
    page.locator(MANAGE).click()
    page.get_by_text("On this plant stand 3 experiments").wait_for()
    page.get_by_role("button", name="Delete with all 3 that stand on it").click()
    page.get_by_text("Deleted: to be changed, and with it 3 experiments.").wait_for()
    page.get_by_role("link", name="bin", exact=True).click()
    visit.wait()
    page.get_by_role("row", name="to be changed").get_by_text("3 more").wait_for()
    assert visit.violations() == []
    page.get_by_role("button", name="Restore to be changed").first.click()
    page.locator("#restored").get_by_role("link", name="to be changed").click()
    page.get_by_role("heading", name="to be changed").wait_for()
    assert len(kept(server, plant)) == 3
    visit.wait()


def test_new_words_are_kept_and_nothing_else_changes(
    visit: Visit, server: Server, plant: Json, experiments: list[Json]
) -> None:
    path = f"/experiments/{experiments[0]['id']}"
    before = Api(server.url).get(path)
    page = visit.open(f"/plants/{plant['id']}{path}")
    page.locator(MANAGE).click()
    page.get_by_label("name", exact=True).fill("cold start, 4 °C")
    with page.expect_navigation():
        page.get_by_role("button", name="Keep these words").click()
    page.get_by_role("heading", name="cold start, 4 °C").wait_for()
    visit.wait()
    assert Api(server.url).get(path) == {**before, "name": "cold start, 4 °C"}


def test_plots_and_tables_are_saved_from_the_page(visit: Visit, plant: Json, experiments: list[Json]) -> None:
    page = visit.open(f"/plants/{plant['id']}/experiments/{experiments[0]['id']}")
    visit.draw_all()
    figure = page.locator("figure").first
    beginnings = {"PNG": b"\x89PNG", "SVG": b"<svg", "CSV": "\ufeffcurve,horizontal,x".encode()}
    for kind, beginning in beginnings.items():
        with page.expect_download() as saving:
            figure.locator(".save").first.get_by_role("button", name=kind).click()
        assert saving.value.suggested_filename.startswith("to-be-changed-run-0-")
        assert saving.value.path().read_bytes().startswith(beginning)
    figure.locator("summary").click()
    with page.expect_download() as saving:
        figure.locator(".scroll .save").get_by_role("button", name="CSV").click()
    rows = saving.value.path().read_text(encoding="utf-8-sig").splitlines()
    assert rows[0].startswith("frequency (Hz),gain (m/N),gain (dB)")
    frequencies = [float(row.split(",")[0]) for row in rows[1:]]
    assert frequencies == sorted(frequencies)
