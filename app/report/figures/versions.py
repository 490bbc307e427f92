"""Versions of a model beside what was measured in one experiment."""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, Axes, hertz, labelled
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import NEUTRAL, add_band, colour, dash, new_figure
from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.batch import EXCITED, Batch
from identification.confidence import gain_and_phase
from identification.extension.response import linear_response, response_phase
from identification.models.model import Model

Version = tuple[str, Model]
TABLE_ROWS = 9


def side_by_side(versions: Sequence[Version], batch: Batch, label: str, axes: Axes) -> Plot:
    """Gain, phase and error of what each version says of the first experiment of a batch, at its excited lines.

    The 95 % bands are those of the frequency response, from the covariance of the parameters.
    """
    used = (batch.classes[0] == EXCITED) & np.isfinite(batch.variances[0]) & (batch.omega > 0)
    omega, input_lines = batch.omega[used], batch.inputs[0, used]
    measured = batch.outputs[0, used] / input_lines
    figure = new_figure(("gain", "phase", "error"), heights=(0.42, 0.26, 0.32), height=680)
    marker = {"size": 5, "color": NEUTRAL, "opacity": 0.8}
    phase = _phase(versions[0][1], batch, omega, measured)
    for row, y in enumerate((abs(measured), np.rad2deg(phase)), start=1):
        common = {"mode": "markers", "name": "measured", "legendgroup": "measured", "showlegend": row == 1}
        figure.add_scatter(x=hertz(omega), y=y, marker=marker, row=row, col=1, **common)
    noise = np.sqrt(batch.variances[0, used]) / abs(input_lines)
    line = {"color": NEUTRAL, "width": 4}
    figure.add_scatter(x=hertz(omega), y=noise, mode="lines", line=line, name="noise (σ)", opacity=0.6, row=3, col=1)
    said = [_said(model, batch, used) for _, model in versions]
    for i, ((name, model), response) in enumerate(zip(versions, said, strict=True)):
        _add_version(figure, name, i, omega, response, measured, phase)
        _add_bands(figure, model, batch, omega, response, name, i)
    figure.update_xaxes(type="log", dtick=1)
    figure.update_xaxes(title=FREQUENCY, row=3, col=1)
    figure.update_yaxes(type="log", dtick=1, exponentformat="power", title=axes.gain_unit, row=1, col=1)
    figure.update_yaxes(title="degrees", row=2, col=1)
    figure.update_yaxes(type="log", dtick=1, exponentformat="power", title=axes.gain_unit, row=3, col=1)
    figure.update_layout(margin={"t": 75}, legend={"y": 1.07})
    caption = (
        f"{label}: measured response, what each version says of this very experiment (with the 95 % band of its linear"
        " part), and how far both are from what was measured; grey, the noise."
    )
    return Plot(figure, caption, _table(versions, omega, measured, said, noise, axes))


def _said(model: Model, batch: Batch, used: BoolArray) -> ComplexArray:
    """Ŷ/U at the excited lines, (F,)."""
    return np.asarray(model.output(batch)[0, used] / batch.inputs[0, used])


def _phase(model: Model, batch: Batch, omega: FloatArray, measured: ComplexArray) -> FloatArray:
    """arg of what was measured, on the turn of what a model says."""
    said = linear_response(model, batch.points[:1], omega).response[0]
    return np.asarray(response_phase(model, batch.points[0], omega) + np.angle(measured / said))


def _add_version(
    figure: go.Figure,
    name: str,
    i: int,
    omega: FloatArray,
    response: ComplexArray,
    measured: ComplexArray,
    measured_phase: FloatArray,
) -> None:
    phase = measured_phase + np.angle(response / measured)
    line = {"color": colour(i), "dash": dash(i), "width": 2}
    common = {"mode": "lines", "line": line, "name": name, "legendgroup": name, "x": hertz(omega), "col": 1}
    figure.add_scatter(y=abs(response), row=1, **common)
    figure.add_scatter(y=np.rad2deg(phase), showlegend=False, row=2, **common)
    marker = {"size": 5, "color": colour(i), "symbol": "circle-open" if i else "diamond"}
    common = {"mode": "markers", "marker": marker, "name": name, "legendgroup": name, "showlegend": False}
    figure.add_scatter(x=hertz(omega), y=np.maximum(abs(response - measured), 1e-300), row=3, col=1, **common)


def _add_bands(
    figure: go.Figure, model: Model, batch: Batch, omega: FloatArray, response: ComplexArray, name: str, i: int
) -> None:
    covariance = linear_response(model, batch.points[:1], omega).covariance
    if covariance is None:
        return
    low, high = gain_and_phase(response, covariance[0]).gain_band()
    add_band(figure, hertz(omega), np.maximum(low, 1e-3 * high), high, colour(i), 1, group=name)


def _table(
    versions: Sequence[Version],
    omega: FloatArray,
    measured: ComplexArray,
    said: Sequence[ComplexArray],
    noise: FloatArray,
    axes: Axes,
) -> Table:
    heads = (FREQUENCY, labelled("measured gain", axes.gain_unit), "noise σ")
    rows = []
    for f in np.unique(np.linspace(0, len(omega) - 1, TABLE_ROWS).astype(int)):
        both = (value for one in said for value in (abs(one[f]), abs(one[f] - measured[f])))
        rows.append((significant(hertz(omega)[f]), *(significant(v, 4) for v in (abs(measured[f]), noise[f], *both))))
    names = tuple(text for name, _ in versions for text in (f"gain, {name}", f"error, {name}"))
    return Table((*heads, *names), tuple(rows))
