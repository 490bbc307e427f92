"""Accuracy asked for, expected by the design, and reached."""

from dataclasses import dataclass

from app.report.document import Plot, Table
from app.report.numbers import percent, significant
from app.report.style import NEUTRAL, PALETTE, new_figure
from identification.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Accuracy:
    """Standard deviations of the parameters (k,), and the errors θ̂ − θ where the truth is known."""

    names: tuple[str, ...]
    asked: FloatArray
    expected: FloatArray
    reached: FloatArray
    error: FloatArray | None = None


def accuracy(figures: Accuracy) -> Plot:
    """Bars of standard deviations in % of what was asked, a group a parameter; errors as markers."""
    figure = new_figure(height=380)
    for name, values, colour in (
        ("expected by the design", figures.expected, PALETTE[5]),
        ("reached", figures.reached, PALETTE[0]),
    ):
        figure.add_bar(x=figures.names, y=100 * values / figures.asked, name=name, marker={"color": colour})
    if figures.error is not None:
        marker = {"symbol": "diamond", "size": 10, "color": PALETTE[1]}
        share = 100 * abs(figures.error) / figures.asked
        figure.add_scatter(x=figures.names, y=share, mode="markers", marker=marker, name="actual error |θ̂ − θ|")
    figure.add_hline(y=100, line={"color": NEUTRAL, "dash": "dash"})
    figure.update_yaxes(title="% of σ asked", rangemode="tozero")
    caption = "Standard deviation of each parameter, in % of what was asked for (dashed line)."
    return Plot(figure, caption, accuracy_table(figures))


def accuracy_table(figures: Accuracy) -> Table:
    """The same numbers in the units of the parameters."""
    heads = ("parameter", "σ asked", "σ expected", "σ reached", "reached / asked")
    rows = [
        (name, *(significant(value, 3) for value in values), percent(values[2] / values[0]))
        for name, *values in zip(figures.names, figures.asked, figures.expected, figures.reached, strict=True)
    ]
    if figures.error is None:
        return Table(heads, tuple(rows))
    errors = zip(rows, figures.error, figures.reached, strict=True)
    with_errors = tuple((*row, significant(error, 2), significant(error / sigma, 2)) for row, error, sigma in errors)
    return Table((*heads, "actual error", "error / σ reached"), with_errors)
