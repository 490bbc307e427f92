"""A report in a browser: drawn without a server, every figure saved as SVG, PNG and CSV, tables open when printed."""

from pathlib import Path
from typing import TYPE_CHECKING

from app.report.document import Fact, Plot, Report, Section, Table
from app.report.page import write
from app.report.style import new_figure

if TYPE_CHECKING:
    from playwright.sync_api import Browser

SIGNATURES = {"PNG": b"\x89PNG", "CSV": "\ufefffrequency (Hz),gain".encode(), "SVG": b"<svg"}


def report() -> Report:
    figure = new_figure()
    figure.add_scatter(x=[1.0, 10.0], y=[2.0, 3.0], mode="lines+markers")
    table = Table(("frequency (Hz)", "gain"), (("1", "2"), ('10, "about"', "−3.0·10⁻¹²")))
    return Report(
        "A report", "Of a plant.", (Fact("1", "one"),), (Section("Found", (), (Plot(figure, "Gain.", table),)),)
    )


def test_figures_are_saved_and_tables_are_printed(browser: "Browser", tmp_path: Path) -> None:
    path = write(report(), tmp_path / "report.html")
    with browser.new_context(viewport={"width": 390, "height": 900}) as context:
        page, faults = context.new_page(), []
        page.on("console", lambda message: faults.append(message.text))
        page.on("request", lambda request: faults.append(request.url) if request.url.startswith("http") else None)
        page.goto(path.as_uri())
        assert page.locator("figure svg circle").count() == 2
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
        for kind, beginning in SIGNATURES.items():
            with page.expect_download() as saving:
                page.get_by_role("button", name=f"Save {kind}").click()
            assert saving.value.suggested_filename == f"gain.{kind.lower()}"
            content = saving.value.path().read_bytes()
            assert content.startswith(beginning)
            assert kind != "CSV" or b'"10, ""about""",-3.0e-12' in content
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        assert page.locator("details[open]").count() == 1
        page.emulate_media(media="print")
        assert page.locator(".save").first.is_hidden()
        assert page.locator("figure").evaluate("(one) => getComputedStyle(one).breakInside") == "avoid"
        assert faults == []
