"""A report as one HTML file: style and plots inside, nothing fetched, the same bytes for the same report."""

from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from app.report.document import Plot, Report, Table
from app.report.svg.draw import draw


@dataclass
class _Numbering:
    """Gives plots their ids in the order in which the page meets them."""

    count: int = 0

    def next_id(self) -> str:
        self.count += 1
        return f"plot-{self.count}"


def render(report: Report) -> str:
    """The page as text."""
    environment = Environment(
        loader=PackageLoader("app.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.tests["plot"] = lambda block: isinstance(block, Plot)
    environment.tests["table"] = lambda block: isinstance(block, Table)
    environment.filters["drawn"] = drawn
    template = environment.get_template("report.html.j2")
    return template.render(report=report, numbering=_Numbering())


def write(report: Report, path: Path) -> Path:
    """The page as a file, its folder made where there is none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(render(report), encoding="utf-8")
    return path


def drawn(plot: Plot, identifier: str) -> Markup:
    """The figure of a plot as an svg element, all text in it escaped."""
    return Markup(draw(plot.figure, identifier, plot.caption))
