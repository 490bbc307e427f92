"""Frequency responses with what is known of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, Axes, hertz, labelled
from app.report.document import Plot, Table
from app.report.numbers import estimate, significant
from app.report.style import NEUTRAL, add_band, add_truth, colour, dash, new_figure
from identification.arrays import FloatArray
from identification.confidence import QUANTILE_95, GainAndPhase, gain_and_phase
from identification.extension.response import response_phase
from identification.models.model import Model
from identification.signals import FrequencyResponse, OperatingPoint

TABLE_ROWS = 9
WORST_SHOWN = 0.3


def bode(
    model: Model,
    points: Sequence[OperatingPoint],
    omega: FloatArray,
    axes: Axes,
    measured: Sequence[FrequencyResponse] = (),
    truth: Model | None = None,
) -> Plot:
    """Gain and phase at chosen operating points with 95 % bands, measured points, and the true response if known."""
    figure = new_figure(("gain", "phase"), heights=(0.58, 0.42), height=600)
    for i, point in enumerate(points):
        if truth is not None:
            _add_truth(figure, truth, point, omega, show=i == 0)
        name = axes.point(point)
        own = [response for response in measured if response.operating_point == point]
        _add_measured(figure, model, own, name, i)
        _add_model(figure, model, point, omega, name, i)
    figure.update_xaxes(type="log", dtick=1)
    figure.update_xaxes(title=FREQUENCY, row=2, col=1)
    figure.update_yaxes(type="log", title=axes.gain_unit, dtick=1, row=1, col=1)
    figure.update_yaxes(title="degrees", row=2, col=1)
    figure.update_layout(margin={"t": 70}, legend={"y": 1.07})
    caption = "Frequency response of the model with 95 % bands"
    caption += "; dots are measured to better than 30 %" if measured else ""
    caption += "; the broad line is the truth." if truth is not None else "."
    return Plot(figure, caption, _table(model, points, omega, axes, truth))


def gain_accuracy(
    models: Sequence[tuple[str, Model]],
    points: Sequence[OperatingPoint],
    omega: FloatArray,
    axes: Axes,
    truth: Model | None = None,
) -> Plot:
    """95 % bands of the gain in % over frequency, one row an operating point, later models being the better ones."""
    height = 110 + 150 * len(points)
    figure = new_figure([axes.point(point) for point in points], height=height)
    hues = (NEUTRAL, *(colour(i) for i in range(len(models))))
    for row, point in enumerate(points, start=1):
        for (name, model), hue in zip(models, hues, strict=False):
            width = _half_widths(model, point, omega)
            add_band(figure, hertz(omega), -width, width, hue, row, group=name, show=truth is None and row == 1)
            if truth is not None:
                error = 100 * (_known(model, point, omega).gain / _known(truth, point, omega).gain - 1)
                _add_curve(figure, hertz(omega), error, row, name, {"color": hue, "width": 2}, row == 1)
        figure.update_yaxes(title="%", row=row, col=1)
    figure.update_xaxes(type="log", dtick=1)
    figure.update_xaxes(title=FREQUENCY, row=len(points), col=1)
    figure.update_layout(margin={"t": 70}, legend={"y": 1 + 40 / height})
    shown = "Error of the gain (curves) and its 95 % band (areas)" if truth is not None else "95 % band of the gain"
    return Plot(figure, f"{shown}, in % of the gain.", _accuracy_table(models, points, omega, axes))


def _add_model(figure: go.Figure, model: Model, point: OperatingPoint, omega: FloatArray, name: str, i: int) -> None:
    known = _known(model, point, omega)
    line = {"color": colour(i), "dash": dash(i), "width": 2}
    low, high = known.gain_band()
    low_phase, high_phase = map(np.rad2deg, known.phase_band())
    add_band(figure, hertz(omega), np.maximum(low, 1e-3 * high), high, colour(i), 1, group=name)
    add_band(figure, hertz(omega), low_phase, high_phase, colour(i), 2, group=name)
    _add_curve(figure, hertz(omega), known.gain, 1, name, line, True)
    _add_curve(figure, hertz(omega), np.rad2deg(known.phase), 2, name, line, False)


def _add_measured(figure: go.Figure, model: Model, measured: Sequence[FrequencyResponse], name: str, i: int) -> None:
    """Only points with a known noise of less than 30 %; the rest is noise and would hide the others."""
    marker = {"size": 5, "color": colour(i), "opacity": 0.6}
    for response in measured:
        omega, values = response.frequencies, response.response
        noise = np.zeros(len(omega)) if response.variance is None else np.sqrt(response.variance)
        kept = (omega > 0) & (noise < WORST_SHOWN * abs(values))
        near = model.frequency_response([response.operating_point], omega)[0, :, 0, 0]
        phase = _known(model, response.operating_point, omega).phase + np.angle(values / near)
        for row, y in enumerate((abs(values), np.rad2deg(phase)), start=1):
            common = {"mode": "markers", "name": name, "legendgroup": name, "showlegend": False}
            figure.add_scatter(x=hertz(omega[kept]), y=y[kept], marker=marker, row=row, col=1, **common)


def _add_truth(figure: go.Figure, truth: Model, point: OperatingPoint, omega: FloatArray, show: bool) -> None:
    known = _known(truth, point, omega)
    add_truth(figure, hertz(omega), known.gain, 1, show)
    add_truth(figure, hertz(omega), np.rad2deg(known.phase), 2, False)


def _add_curve(
    figure: go.Figure, x: FloatArray, y: FloatArray, row: int, name: str, line: dict[str, object], show: bool
) -> None:
    common = {"mode": "lines", "name": name, "legendgroup": name, "showlegend": show}
    figure.add_scatter(x=x, y=y, line=line, row=row, col=1, **common)


def _known(model: Model, point: OperatingPoint, omega: FloatArray) -> GainAndPhase:
    response, covariance = (
        model.frequency_response([point], omega)[0, :, 0, 0],
        model.response_covariance([point], omega)[0, :, 0, 0],
    )
    return gain_and_phase(response, covariance, response_phase(replace(model, effects=()), point, omega))


def _half_widths(model: Model, point: OperatingPoint, omega: FloatArray) -> FloatArray:
    """Of the 95 % band of the gain, in % of the gain."""
    known = _known(model, point, omega)
    return np.asarray(100 * QUANTILE_95 * known.gain_deviation / known.gain)


def _table(model: Model, points: Sequence[OperatingPoint], omega: FloatArray, axes: Axes, truth: Model | None) -> Table:
    chosen = omega[np.linspace(0, len(omega) - 1, TABLE_ROWS).astype(int)]
    heads = ("operating point", FREQUENCY, labelled("gain ± 95 %", axes.gain_unit), "phase ± 95 % (degrees)")
    rows = []
    for point in points:
        known = _known(model, point, chosen)
        true_gain = None if truth is None else _known(truth, point, chosen).gain
        for f, frequency in enumerate(chosen):
            row = (axes.point(point), significant(frequency / (2 * np.pi)), *_with_bands(known, f))
            rows.append(row if true_gain is None else (*row, significant(true_gain[f], 4)))
    return Table(heads if truth is None else (*heads, labelled("true gain", axes.gain_unit)), tuple(rows))


def _with_bands(known: GainAndPhase, f: int) -> tuple[str, str]:
    gain = estimate(known.gain[f], QUANTILE_95 * known.gain_deviation[f])
    return gain, estimate(*np.rad2deg([known.phase[f], QUANTILE_95 * known.phase_deviation[f]]))


def _accuracy_table(
    models: Sequence[tuple[str, Model]], points: Sequence[OperatingPoint], omega: FloatArray, axes: Axes
) -> Table:
    rows = []
    for point in points:
        widths = [float(_half_widths(model, point, omega).max()) for _, model in models]
        rows.append((axes.point(point), *(f"{significant(width, 2)} %" for width in widths)))
    heads = ("operating point", *(name for name, _ in models))
    return Table(heads, tuple(rows), "Largest 95 % half-width of the gain over frequency, in % of the gain")
