"""The versions of a model as a staircase of errors."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

from app.report.document import Plot, Table
from app.report.numbers import percent, probability, significant
from app.report.style import colour, dash, new_figure, wrapped


@dataclass(frozen=True)
class Step:
    """A version of the model: what was added, its relative errors, and the p-value of its lack of fit."""

    added: str
    fitted: float
    held_out: float | None
    p_value: float | None


def staircase(steps: Sequence[Step]) -> Plot:
    """Relative errors on fitted and on held-out data, falling from version to version."""
    figure = new_figure(height=340)
    places = list(range(len(steps) + 1))
    curves: list[tuple[str, list[float | None]]] = [
        ("fitted", [one.fitted for one in steps]),
        ("held out", [one.held_out for one in steps]),
    ]
    for i, (name, values) in enumerate(curves):
        shown = [100 * value for value in values if value is not None]
        if len(shown) < len(steps):
            continue
        line = {"shape": "hv", "color": colour(i), "dash": dash(i), "width": 2.5}
        figure.add_scatter(x=places, y=[*shown, shown[-1]], mode="lines", line=line, name=name)
        figure.add_scatter(
            x=[place + 0.3 + 0.4 * i for place in places[:-1]],
            y=shown,
            mode="text",
            text=[f"{significant(value)} %" for value in shown],
            textposition="top center",
            cliponaxis=False,
            showlegend=False,
        )
    labels = [wrapped(one.added, 16) for one in steps]
    figure.update_xaxes(
        tickmode="array", tickvals=[place + 0.5 for place in places[:-1]], ticktext=labels, showgrid=False
    )
    errors = [100 * value for _, values in curves for value in values if value is not None]
    low, high = floor(log10(max(min(errors), 1e-12)) - 0.05), ceil(log10(max(*errors, 1e-12)) + 0.1)
    ticks = [digit * 10.0**power for power in range(low, high) for digit in (1, 2, 5)]
    span = [log10(max(min(errors), 1e-12)) - 0.1, log10(max(*errors, 1e-12)) + 0.15]
    figure.update_yaxes(title="relative error (%)", type="log", range=span)
    figure.update_yaxes(tickmode="array", tickvals=ticks, ticktext=[f"{tick:g}" for tick in ticks])
    caption = "Relative error ‖Y − Ŷ‖/‖Y‖ of each version at the excited lines, on fitted and on held-out experiments."
    return Plot(figure, caption, staircase_table(steps))


def staircase_table(steps: Sequence[Step]) -> Table:
    """The same numbers, with the tests."""
    rows = tuple(
        (
            one.added,
            percent(one.fitted),
            "–" if one.held_out is None else percent(one.held_out),
            "–" if one.p_value is None else probability(one.p_value),
        )
        for one in steps
    )
    return Table(("version", "error, fitted", "error, held out", "p-value of the lack of fit"), rows)
