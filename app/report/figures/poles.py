"""Poles over the scheduling range."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from app.report.axes import Axes
from app.report.deviations import poles_with_deviations
from app.report.document import Plot, Table
from app.report.numbers import estimate, significant
from app.report.style import NEUTRAL, add_band, colour, new_figure
from identification.arrays import ComplexArray, FloatArray
from identification.confidence import QUANTILE_95
from identification.estimates import LocalEstimate
from identification.models import LpvModel

TABLE_ROWS = 9


def poles(
    model: LpvModel,
    points: FloatArray,
    axes: Axes,
    local: Sequence[LocalEstimate] = (),
    truth: LpvModel | None = None,
) -> Plot:
    """Real and imaginary parts of the poles along operating points (M, s), with 95 % bands and local estimates."""
    values, *_ = poles_with_deviations(model, points)
    parts = ("real part", "imaginary part") if np.any(abs(values.imag) > 0) else ("real part",)
    unit = "" if model.structure.is_discrete else " (rad/s)"
    figure = new_figure(parts if len(parts) > 1 else ("",), height=60 + 300 * len(parts))
    for row, part in enumerate(parts, start=1):
        _add_model(figure, model, points, row)
        _add_local(figure, local, row)
        if truth is not None:
            _add_truth(figure, truth, points, row)
        figure.update_yaxes(title=f"pole, {part}{unit}", row=row, col=1)
    figure.update_xaxes(title=axes.scheduling, row=len(parts), col=1)
    caption = f"Poles of the model{' (z-plane)' if model.structure.is_discrete else ''} with their 95 % bands."
    return Plot(figure, caption, _table(model, points, axes, truth))


def _part(values: ComplexArray, row: int) -> FloatArray:
    return np.asarray(values.real if row == 1 else values.imag)


def _add_model(figure: go.Figure, model: LpvModel, points: FloatArray, row: int) -> None:
    values, *deviations = poles_with_deviations(model, points)
    middle, half, x = _part(values, row), QUANTILE_95 * deviations[row - 1], points[:, 0].tolist()
    for i in range(values.shape[1]):
        add_band(figure, x, (middle - half)[:, i].tolist(), (middle + half)[:, i].tolist(), colour(i), row, 0.3)
        name = "model" if values.shape[1] == 1 else f"model, pole {i + 1}"
        line = {"color": colour(i), "width": 2}
        figure.add_scatter(x=x, y=middle[:, i], mode="lines", line=line, name=name, showlegend=row == 1, row=row, col=1)


def _add_local(figure: go.Figure, local: Sequence[LocalEstimate], row: int) -> None:
    at, values = [], []
    for found in local:
        for pole in found.model.structure.poles(found.model.zeta):
            at.append(found.model.operating_point[0])
            values.append(float(_part(pole, row)))
    if values:
        marker = {"symbol": "circle-open", "size": 9, "color": colour(1), "line": {"width": 2}}
        name = "local estimates"
        figure.add_scatter(
            x=at, y=values, mode="markers", marker=marker, name=name, showlegend=row == 1, row=row, col=1
        )


def _add_truth(figure: go.Figure, truth: LpvModel, points: FloatArray, row: int) -> None:
    values = np.sort_complex(truth.poles(points))
    line = {"color": NEUTRAL, "dash": "dot", "width": 2}
    for i in range(values.shape[1]):
        show, y = row == 1 and i == 0, _part(values[:, i], row)
        figure.add_scatter(x=points[:, 0], y=y, mode="lines", line=line, name="truth", showlegend=show, row=row, col=1)


def _table(model: LpvModel, points: FloatArray, axes: Axes, truth: LpvModel | None) -> Table:
    chosen = points[np.linspace(0, len(points) - 1, TABLE_ROWS).astype(int)]
    values, real, imaginary = poles_with_deviations(model, chosen)
    true = None if truth is None else np.sort_complex(truth.poles(chosen))
    rows: list[tuple[str, ...]] = []
    for m, point in enumerate(chosen):
        for x, pole in enumerate(values[m]):
            imaginary_part = estimate(pole.imag, imaginary[m, x]) if pole.imag else "0"
            row = (axes.point(tuple(point)), estimate(pole.real, real[m, x]), imaginary_part)
            rows.append(row if true is None else (*row, _complex(true[m, x])))
    heads = ("operating point", "real part ± standard deviation", "imaginary part ± standard deviation")
    return Table(heads if true is None else (*heads, "truth"), tuple(rows))


def _complex(value: complex) -> str:
    imaginary = f" {'+' if value.imag > 0 else '−'} {significant(abs(value.imag), 4)}j" if value.imag else ""
    return significant(value.real, 4) + imaginary
