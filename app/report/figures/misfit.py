"""How large the misfit is, by operating point, by band of frequencies and by class of lines."""

from collections.abc import Callable, Sequence

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, Axes, hertz
from app.report.document import Plot, Table
from app.report.numbers import probability, significant
from app.report.style import NEUTRAL, colour, new_figure
from app.schemas.comparisons import ComparisonPart
from app.schemas.outcomes import TestDocument

Named = tuple[str, TestDocument]
NAMES = {"fitted": "fitted", "heldOut": "held out"}
EXPECTED = "1 is expected where nothing is missing (dashed); bars with an outline have a p-value below 0.001."


def misfit_by_point(parts: Sequence[ComparisonPart], axes: Axes) -> Plot:
    """Lack of fit at each operating point."""
    caption = f"Lack of fit at each operating point, χ² per degree of freedom. {EXPECTED}"
    several = len(axes.variables) > 1

    def label(point: list[float]) -> str:
        return axes.point(tuple(point)) if several else f"{point[0]:g}"

    plot = _bars(parts, lambda part: [(label(one.operating_point), one.test) for one in part.by_point], caption)
    order = sorted({tuple(one.operating_point) for part in parts for one in part.by_point})
    ordered = {"type": "category", "categoryorder": "array", "categoryarray": [label(list(p)) for p in order]}
    plot.figure.update_xaxes(title=None if several else axes.scheduling, **ordered)
    return plot


def misfit_by_band(parts: Sequence[ComparisonPart]) -> Plot:
    """Lack of fit in each band of frequencies."""
    caption = f"Lack of fit below, in, and above the excited band, χ² per degree of freedom. {EXPECTED}"
    plot = _bars(
        parts,
        lambda part: [
            (_band(one.minimum_rad_per_second, one.maximum_rad_per_second), one.test) for one in part.by_band
        ],
        caption,
    )
    plot.figure.update_xaxes(title=FREQUENCY)
    return plot


def misfit_by_class(parts: Sequence[ComparisonPart]) -> Plot:
    """Lack of fit at excited and unexcited lines."""
    caption = (
        "Lack of fit by class of lines, χ² per degree of freedom: excited lines show wrong linear dynamics, unexcited"
        f" odd and even ones odd and even nonlinearity. {EXPECTED}"
    )
    return _bars(parts, lambda part: [(test.name, test) for test in part.by_line_class], caption)


def overall_table(parts: Sequence[ComparisonPart]) -> Table:
    """The tests of the whole, and whether it is the dynamics or their dependence on the operating point."""
    rows = []
    for part in parts:
        tests = [("lack of fit", part.lack_of_fit), ("lack of fit after a refit", part.refitted)]
        tests += [("dependence on the operating point", part.dependence)]
        tests += [("dynamics at each operating point", part.dynamics)]
        rows += [(name, NAMES[part.data], *_numbers(test)) for name, test in tests if test is not None]
    heads = ("test", "data", "χ²", "degrees of freedom", "χ² per degree", "p-value")
    return Table(heads, tuple(rows), "A p-value below 0.05 comes up in one of twenty when the model is right", 2)


def ratio(test: TestDocument) -> float:
    """χ² per degree of freedom; not a number where there is none."""
    if test.statistic is None or not test.degrees_of_freedom:
        return float("nan")
    return test.statistic / test.degrees_of_freedom


def _bars(parts: Sequence[ComparisonPart], tests: Callable[[ComparisonPart], list[Named]], caption: str) -> Plot:
    figure, rows = new_figure(height=320), []
    for i, part in enumerate(parts):
        found = tests(part)
        _add_bars(figure, found, NAMES[part.data], i)
        rows += [(name, NAMES[part.data], *_numbers(test)) for name, test in found]
    figure.add_hline(y=1.0, line={"color": NEUTRAL, "dash": "dash"})
    figure.update_yaxes(title="χ² per degree of freedom", type="log", dtick=1, exponentformat="power")
    heads = ("where", "data", "χ²", "degrees of freedom", "χ² per degree", "p-value")
    return Plot(figure, caption, Table(heads, tuple(rows), text_columns=2))


def _add_bars(figure: go.Figure, found: Sequence[Named], name: str, i: int) -> None:
    doubtful = np.array([test.p_value is not None and test.p_value < 1e-3 for _, test in found])
    figure.add_bar(
        x=[label for label, _ in found],
        y=[max(ratio(test), 0.1) for _, test in found],
        name=name,
        marker={"color": colour(2 * i), "line": {"color": NEUTRAL, "width": np.where(doubtful, 2.5, 0.0)}},
        text=[significant(ratio(test), 2) for _, test in found],
        textposition="outside",
        cliponaxis=False,
    )


def _numbers(test: TestDocument) -> tuple[str, ...]:
    nothing = float("nan")
    statistic, freedom, p = (
        nothing if value is None else value for value in (test.statistic, test.degrees_of_freedom, test.p_value)
    )
    return significant(statistic, 4), significant(freedom, 4), significant(ratio(test)), probability(p)


def _band(low: float, high: float | None) -> str:
    if high is None:
        return f"> {significant(float(hertz(low)), 2)}"
    return f"{significant(float(hertz(low)), 2)} to {significant(float(hertz(high)), 2)}"
