"""Poles over the scheduling range."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from app.report.axes import Axes
from app.report.deviations import local_poles, poles_of
from app.report.document import Plot, Table
from app.report.numbers import estimate, significant
from app.report.style import add_band, add_truth, colour, new_figure
from identification.arrays import FloatArray
from identification.confidence import QUANTILE_95
from identification.estimates import LocalEstimate
from identification.models.model import Model

TABLE_ROWS = 9
PARTS = ("real part", "imaginary part")


def poles(
    model: Model,
    points: FloatArray,
    axes: Axes,
    local: Sequence[LocalEstimate] = (),
    truth: Model | None = None,
) -> Plot:
    """Real and imaginary parts of the poles along operating points (M, s), with 95 % bands and local estimates."""
    parts = PARTS if np.any(model.poles(points).imag != 0) else PARTS[:1]
    unit = "" if model.structure.is_discrete else " (rad/s)"
    figure = new_figure(parts if len(parts) > 1 else ("",), height=80 + 280 * len(parts))
    for row, part in enumerate(parts, start=1):
        if truth is not None:
            values = poles_of(truth, points).part(row - 1)[0]
            for i, curve in enumerate(values.T):
                add_truth(figure, points[:, 0], curve, row, show=row == 1 and i == 0)
        _add_model(figure, model, points, row)
        _add_local(figure, local, row)
        figure.update_yaxes(title=f"{part}{unit}", row=row, col=1)
    figure.update_xaxes(title=axes.scheduling, row=len(parts), col=1)
    where = " in the z-plane" if model.structure.is_discrete else ""
    caption = f"Poles of the model{where} with their 95 % bands"
    caption += "; circles, local estimates with their 95 % intervals." if local else "."
    return Plot(figure, caption, _table(model, points, axes, truth))


def _add_model(figure: go.Figure, model: Model, points: FloatArray, row: int) -> None:
    middle, deviation = poles_of(model, points).part(row - 1)
    half, x = QUANTILE_95 * deviation, points[:, 0]
    for i, curve in enumerate(middle.T):
        add_band(figure, x, curve - half[:, i], curve + half[:, i], colour(i), row)
        name = "model" if middle.shape[1] == 1 else f"model, pole {i + 1}"
        line = {"color": colour(i), "width": 2}
        figure.add_scatter(x=x, y=curve, mode="lines", line=line, name=name, showlegend=row == 1, row=row, col=1)


def _add_local(figure: go.Figure, local: Sequence[LocalEstimate], row: int) -> None:
    if not local:
        return
    found = [local_poles(one.model).part(row - 1) for one in local]
    order = found[0][0].shape[1]
    at = np.repeat([one.model.operating_point[0] for one in local], order)
    values, deviations = (np.concatenate([pair[i].ravel() for pair in found]) for i in (0, 1))
    marker = {"symbol": "circle-open", "size": 8, "color": colour(1), "line": {"width": 2}}
    error = {"type": "data", "array": QUANTILE_95 * deviations, "thickness": 1.5, "width": 4, "color": colour(1)}
    figure.add_scatter(
        x=at,
        y=values,
        error_y=error,
        mode="markers",
        marker=marker,
        name="local estimates",
        showlegend=row == 1,
        row=row,
        col=1,
    )


def _table(model: Model, points: FloatArray, axes: Axes, truth: Model | None) -> Table:
    chosen = _some(points)
    found = poles_of(model, chosen)
    true = None if truth is None else np.sort_complex(truth.poles(chosen))
    rows: list[tuple[str, ...]] = []
    for m, point in enumerate(chosen):
        for x, pole in enumerate(found.values[m]):
            imaginary = estimate(pole.imag, found.imaginary_deviation[m, x]) if pole.imag else "0"
            row = (axes.point(tuple(point)), estimate(pole.real, found.real_deviation[m, x]), imaginary)
            rows.append(row if true is None else (*row, _complex(true[m, x])))
    heads = ("operating point", "real part ± standard deviation", "imaginary part ± standard deviation")
    return Table(heads if true is None else (*heads, "truth"), tuple(rows))


def _some(points: FloatArray) -> FloatArray:
    return np.asarray(points[np.linspace(0, len(points) - 1, TABLE_ROWS).astype(int)])


def _complex(value: complex) -> str:
    imaginary = f" {'+' if value.imag > 0 else '−'} {significant(abs(value.imag), 4)}j" if value.imag else ""
    return significant(value.real, 4) + imaginary
