"""The accuracy that a design is expected to bring."""

from collections.abc import Sequence

from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import colour, new_figure

Deviations = Sequence[float | None] | None
SYMBOLS = ("line-ew-open", "circle-open", "circle")
SIZES = (24, 11, 11)


def expected_accuracy(
    names: Sequence[str], asked: Deviations, before: Deviations, after: Sequence[float | None]
) -> Plot:
    """Standard deviations of the parameters: asked for, known before and expected after the experiments."""
    series = [("asked for", asked), ("before", before), ("after the experiments", after)]
    figure = new_figure(height=340)
    shown = []
    for i, (name, values) in enumerate(series):
        if values is None or all(value is None for value in values):
            continue
        shown.append((name, values))
        marker = {
            "symbol": SYMBOLS[i],
            "size": SIZES[i],
            "color": colour(i),
            "line": {"width": 2.5, "color": colour(i)},
        }
        figure.add_scatter(x=list(names), y=list(values), mode="markers", name=name, marker=marker)
    figure.update_xaxes(type="category")
    figure.update_yaxes(title="standard deviation", type="log", exponentformat="power", dtick=1)
    rows = tuple((name, *(_text(values[k]) for _, values in shown)) for k, name in enumerate(names))
    caption = "Standard deviation of each parameter, as expected from the designed experiments."
    return Plot(figure, caption, Table(("parameter", *(f"σ {name}" for name, _ in shown)), rows))


def _text(value: float | None) -> str:
    return "–" if value is None else significant(value, 3)
