"""The smooth picture of what a model lacks, and what effects explain of it."""

from collections.abc import Mapping, Sequence

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, Axes, hertz, labelled
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import NEUTRAL, add_band, colour, dash, new_figure
from app.schemas.diagnoses import Diagnosis, MissingResponse
from identification.confidence import QUANTILE_95

MOST = 4


def missing(diagnosis: Diagnosis, labels: Mapping[str, str], axes: Axes) -> Plot:
    """|δG| at the experiments where most is missing, with the 95 % level of noise and the best effects over it."""
    chosen = _worst(diagnosis.missing)
    titles = {one.kind: one.title for one in diagnosis.ranking}
    names = [labels.get(row.experiment_id, axes.point(tuple(row.operating_point))) for row in chosen]
    height = 120 + 190 * len(chosen)
    figure = new_figure(names, height=height)
    for place, row in enumerate(chosen, start=1):
        _add(figure, row, titles, place)
        figure.update_yaxes(title=axes.gain_unit, rangemode="tozero", row=place, col=1)
    figure.update_xaxes(type="log", dtick=1)
    figure.update_xaxes(title=FREQUENCY, row=len(chosen), col=1)
    figure.update_layout(margin={"t": 75}, legend={"y": 1 + 40 / height})
    caption = (
        "What is missing from the frequency response, smoothed (broad line), the size below which it may be noise"
        " (grey, 95 %), and what the effects of most weight explain of it."
    )
    return Plot(figure, caption, _table(chosen, names, titles))


def _worst(rows: Sequence[MissingResponse]) -> list[MissingResponse]:
    """The experiments in which most stands out of the noise, in their own order."""
    excess = [float(np.mean((_size(row) / np.array(row.standard_deviation)) ** 2)) for row in rows]
    chosen = sorted(np.argsort(excess)[::-1][:MOST].tolist())
    return [rows[i] for i in chosen]


def _size(row: MissingResponse) -> np.ndarray:
    return abs(row.response.array())


def _add(figure: go.Figure, row: MissingResponse, titles: dict[str, str], place: int) -> None:
    frequencies = hertz(np.array(row.frequencies_rad_per_second))
    noise = QUANTILE_95 * np.array(row.standard_deviation)
    first = place == 1
    add_band(figure, frequencies, 0 * noise, noise, NEUTRAL, place, 0.25, "noise, 95 %", show=first)
    common = {"mode": "lines", "showlegend": first, "row": place, "col": 1, "x": frequencies}
    line = {"color": NEUTRAL, "width": 6}
    figure.add_scatter(y=_size(row), line=line, name="missing", legendgroup="missing", **common)
    for i, one in enumerate(row.explained):
        name = titles.get(one.kind, one.kind)
        line = {"color": colour(i), "dash": dash(i), "width": 2}
        figure.add_scatter(y=abs(one.response.array()), line=line, name=name, legendgroup=one.kind, **common)


def _table(rows: Sequence[MissingResponse], names: Sequence[str], titles: dict[str, str]) -> Table:
    kinds = [one.kind for one in rows[0].explained] if rows else []
    heads = ("experiment", FREQUENCY, labelled("|δG|", ""), "σ", *(titles.get(k, k) for k in kinds))
    lines = []
    for name, row in zip(names, rows, strict=True):
        for i in np.linspace(0, len(row.frequencies_rad_per_second) - 1, 9).astype(int):
            explained = (significant(abs(one.response.array()[i])) for one in row.explained)
            frequency, size, noise = (
                hertz(np.array(row.frequencies_rad_per_second))[i],
                _size(row)[i],
                row.standard_deviation[i],
            )
            lines.append((name, significant(frequency), significant(size), significant(noise, 2), *explained))
    return Table(heads, tuple(lines))
