"""A report as one HTML file: style, plots and plotly.js inside, nothing fetched, the same bytes for the same report."""

import json
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from app.report.document import Plot, Report, Table


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
    environment.filters["figure_json"] = figure_json
    template = environment.get_template("report.html.j2")
    return template.render(report=report, numbering=_Numbering(), plotly=Markup(get_plotlyjs()))


def write(report: Report, path: Path) -> Path:
    """The page as a file, its folder made where there is none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(render(report), encoding="utf-8")
    return path


def figure_json(plot: Plot) -> Markup:
    """Data and layout for plotly.js, safe inside a script element."""
    figure = json.loads(plot.figure.to_json(engine="json"))
    figure["layout"].pop("template", None)
    return Markup(json.dumps(figure, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"))
