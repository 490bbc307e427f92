"""What all pages share: shells, security headers, theme, jobs, plots and maps."""

import re
from typing import Any

import httpx
import pytest

from app.pages.page import pages
from tests.support.api import Api
from tests.support.browser import Visit
from tests.support.paper import FIGURES, prepared
from tests.support.server import Server

MODULE = "document.querySelector('script[src*=\"/js/shell.js\"]').src.replace('shell.js', {name!r})"
DRAW_MAP = """async ([address, rows, columns]) => {{
  const {{ FieldMap }} = await import({address});
  const frequencies = Array.from({{ length: columns }}, (_, i) => 0.01 * 1.005 ** i);
  const place = document.createElement("div");
  document.querySelector("main").append(place);
  window.chosen = [];
  const values = (row) => frequencies.map((_, i) => Math.sin(i / 40) * (row + 1));
  const given = Array.from({{ length: rows }}, (_, row) =>
    ({{ label: `p = ${{row}}`, frequencies, values: values(row) }}));
  new FieldMap(place, {{
    rows: given, minimum: -rows, maximum: rows, caption: "Residuals.", frequencyTitle: "frequency (Hz)",
    valueTitle: "residual", describe: (row, column) => `row ${{row}}, column ${{column}}`,
    onChoose: (row, column) => window.chosen.push([row, column]),
  }});
}}"""

TWO_FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done))))"

DRAW_PLOTS = """async (address) => {
  const { axis, linkAxes, plot } = await import(address);
  const [near, far] = ["near", "far"].map((id) => {
    const place = document.createElement("div");
    place.id = id;
    document.querySelector("main").append(place);
    return place;
  });
  near.style.marginBottom = "5000px";
  const draw = () => ({ data: [{ x: [0, 1, 2], y: [1, 0, 1] }], layout: { xaxis: axis("x") } });
  const table = () => ({ columns: ["x", "y"], rows: [["0", "1"]] });
  linkAxes([near, far].map((place) => plot(place, { draw, caption: "A curve.", table })));
}"""


def module(visit: Visit, name: str) -> str:
    return str(visit.page.evaluate(MODULE.format(name=name)))


def draw_map(visit: Visit, rows: int, columns: int) -> None:
    script = DRAW_MAP.format(address=repr(module(visit, "map.js")))
    visit.page.evaluate(script, ["", rows, columns])
    visit.page.evaluate(TWO_FRAMES)


def test_every_page_is_a_shell_with_a_strict_policy(server: Server) -> None:
    for page in pages():
        answer = httpx.get(server.url + re.sub(r"\{\w+\}", "x\"'<b>", page.path))
        assert answer.status_code == 200, page.path
        policy = answer.headers["content-security-policy"]
        assert policy.startswith("default-src 'self'; style-src 'self' 'unsafe-inline';")
        assert policy.count("unsafe") == 1
        assert "data:" not in policy
        assert "<b>" not in answer.text
        assert re.findall(r"<script(?![^>]*\bsrc=)|\son\w+=|javascript:|https?://", answer.text) == []


def test_assets_are_kept_for_ever_and_nothing_else_is_served(server: Server) -> None:
    shell = httpx.get(f"{server.url}/plants").text
    addresses = re.findall(r'(?:src|href)="(/static/[^"]+)"', shell)
    plotly = re.search(r"/static/plotly-[^\"]+\.js", shell)
    assert plotly is not None
    for address in [*addresses, plotly[0]]:
        answer = httpx.get(server.url + address)
        assert answer.status_code == 200, address
        assert "immutable" in answer.headers["cache-control"]
    assert httpx.get(f"{server.url}/static/x/js/api.js").headers["cache-control"] == "no-cache"
    for bad in ("js/../../main.py", "%2e%2e/main.py", "js", "js/none.js"):
        assert httpx.get(f"{server.url}/static/x/{bad}").status_code == 404


def test_the_theme_follows_the_system_until_it_is_chosen(visit: Visit) -> None:
    page = visit.open("/plants")
    background = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(background)
    page.emulate_media(color_scheme="dark")
    dark = page.evaluate(background)
    assert dark != light
    page.get_by_role("button", name="Light theme").click()
    assert page.evaluate(background) == light
    visit.open("/jobs")
    assert page.evaluate(background) == light


def test_the_first_stop_of_the_keyboard_skips_the_menu(visit: Visit) -> None:
    page = visit.open("/plants")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Skip to the content"
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "content"


def jobs_of(page: Any, plant: dict[str, Any]) -> Any:
    """The ended jobs of one plant, among those of all that the server has."""
    return page.get_by_role("row").filter(has=page.locator(f'a[href="/plants/{plant["id"]}"]'))


def test_a_job_is_seen_live_and_can_be_cancelled(visit: Visit, server: Server) -> None:
    api = Api(server.url)
    page = visit.open("/jobs")
    plant, model = prepared(api)
    slow = {**FIGURES[7].body(plant, model), "spectrumFamily": {"kind": "fir", "degree": 200}, "tolerance": 1e-8}
    job = api.post("/designs", slow)
    card = page.locator(f'[data-job="{job["id"]}"]')
    card.get_by_role("progressbar").wait_for()
    assert "Designing experiments" in card.inner_text()
    assert card.get_by_role("link", name=plant["name"]).get_attribute("href") == f"/plants/{plant['id']}"
    card.get_by_role("button", name="Cancel").click()
    jobs_of(page, plant).get_by_role("cell", name="cancelled").wait_for()
    assert api.get(f"/jobs/{job['id']}")["state"] == "cancelled"
    assert jobs_of(page, plant).get_by_role("link").inner_text() == plant["name"]


def test_an_ended_job_leads_to_what_it_made_and_to_its_plant(visit: Visit, server: Server) -> None:
    api = Api(server.url)
    plant, model = prepared(api)
    design = api.made("/designs", FIGURES[7].body(plant, model))
    page = visit.open("/jobs")
    row = jobs_of(page, plant)
    made = row.get_by_role("link", name="the design").get_attribute("href")
    assert made == f"/plants/{plant['id']}/design/{design['id']}"
    assert row.get_by_role("link", name=plant["name"]).get_attribute("href") == f"/plants/{plant['id']}"
    api.made(f"/designs/{design['id']}/signals", {"periods": 2})
    jobs_of(visit.open("/jobs"), plant).get_by_role("button", name="the signals").click()
    page.wait_for_url(f"**/plants/{plant['id']}/design/{design['id']}")
    visit.wait()


def test_a_map_is_read_by_mouse_and_by_keyboard(visit: Visit) -> None:
    page = visit.open("/jobs")
    draw_map(visit, rows=5, columns=200)
    canvas = page.get_by_role("application")
    box = canvas.bounding_box()
    assert box is not None
    canvas.click(position={"x": box["width"] - 11, "y": 12})
    assert page.evaluate("window.chosen") == [[4, 199]]
    for key in ("ArrowDown", "ArrowLeft", "Enter"):
        page.keyboard.press(key)
    assert page.evaluate("window.chosen[1]") == [3, 198]
    assert page.locator(".map-reading").inner_text() == "row 3, column 198"


@pytest.mark.parametrize(
    "come_to", ["document.querySelector('#far').scrollIntoView()", "dispatchEvent(new Event('beforeprint'))"]
)
def test_a_plot_is_drawn_when_it_is_come_to_and_has_its_table_before(visit: Visit, come_to: str) -> None:
    page = visit.open("/jobs")
    page.evaluate(DRAW_PLOTS, module(visit, "plots.js"))
    page.locator("#near .main-svg").first.wait_for()
    page.locator("#far summary").evaluate("(summary) => summary.click()")
    assert page.locator("#far").get_by_role("row").count() == 2
    assert page.locator("#far .main-svg").count() == 0
    page.evaluate(come_to)
    page.locator("#far .main-svg").first.wait_for()


def test_zooming_a_plot_zooms_one_that_is_not_drawn_yet(visit: Visit) -> None:
    page = visit.open("/jobs")
    page.evaluate(DRAW_PLOTS, module(visit, "plots.js"))
    page.locator("#near .main-svg").first.wait_for()
    page.evaluate("Plotly.relayout(document.querySelector('#near .plot'), 'xaxis.range', [0, 0.5])")
    page.wait_for_function("document.querySelector('#far .plot').layout?.xaxis.range[1] === 0.5")


@pytest.mark.parametrize("path", ["/plants", "/jobs"])
def test_axe_finds_nothing_grave(visit: Visit, path: str) -> None:
    visit.open(path)
    draw_map(visit, rows=3, columns=20)
    for scheme in ("light", "dark"):
        visit.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
        assert visit.violations() == []


def test_numbers_have_as_many_digits_as_they_are_worth(visit: Visit) -> None:
    visit.open("/jobs")
    script = f"async ([name, values]) => (await import({module(visit, 'numbers.js')!r}))[name](...values)"

    def text(name: str, *values: Any) -> Any:
        return visit.page.evaluate(script, [name, list(values)])

    assert text("significant", 0.00123456) == "0.00123"
    assert text("significant", -1234567) == "−1.23·10⁶"
    assert text("significant", 3e-5) == "3.00·10⁻⁵"
    assert text("quantity", 4.5, "m/s") == "4.50\N{NO-BREAK SPACE}m/s"
    assert text("quantity", None, "m/s") == "not known"
    assert text("estimate", 1.23456, 0.0123) == "1.235 ± 0.012"
    assert text("percent", 0.01) == "1.00 %"
