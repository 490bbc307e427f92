"""Signals to play."""

from collections.abc import Sequence

import numpy as np

from app.report.axes import Axes, labelled
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import NEUTRAL, colour, new_figure
from identification.signals import OperatingPoint
from oed.realisation import RealisedSignal

LONGEST_TABLE = 500
ROUNDING = 1e-10


def signals(points: Sequence[OperatingPoint], realised: Sequence[RealisedSignal], axes: Axes) -> Plot:
    """One period of the signal of each operating point, with the amplitude limit."""
    titles = [axes.point(point) for point in points]
    figure = new_figure(titles, height=80 + 150 * len(titles))
    for row, signal in enumerate(realised, start=1):
        time = np.arange(signal.period) * signal.sample_time
        line = {"shape": "hv", "color": colour(row - 1), "width": 1.4}
        figure.add_scatter(x=time, y=signal.signal, mode="lines", line=line, showlegend=False, row=row, col=1)
        for limit in [] if signal.amplitude_limit is None else [-signal.amplitude_limit, signal.amplitude_limit]:
            figure.add_hline(y=limit, line={"color": NEUTRAL, "dash": "dot"}, row=row, col=1)
        figure.update_yaxes(title=axes.input_unit, row=row, col=1)
    figure.update_xaxes(title="time (s)", row=len(titles), col=1)
    caption = f"One period of the {axes.input_name} at each operating point; dotted, the amplitude limit."
    return Plot(figure, caption, _samples(points, realised, axes))


def _samples(points: Sequence[OperatingPoint], realised: Sequence[RealisedSignal], axes: Axes) -> Table:
    """The first samples of the signals."""
    length = min(LONGEST_TABLE, max(signal.period for signal in realised))
    rows = []
    for t in range(length):
        values = (significant(float(signal.signal[t])) if t < signal.period else "" for signal in realised)
        rows.append((significant(t * realised[0].sample_time), *values))
    return Table(("time (s)", *(axes.point(point) for point in points)), tuple(rows), axes.input)


def signal_table(points: Sequence[OperatingPoint], realised: Sequence[RealisedSignal], axes: Axes) -> Table:
    """What the signals are like."""
    rows = tuple(
        (
            axes.point(point),
            f"{signal.periods} × {signal.period}",
            significant(signal.energy, 4),
            significant(signal.peak),
            significant(signal.crest_factor),
            _worst_line(signal),
        )
        for point, signal in zip(points, realised, strict=True)
    )
    heads = (
        "operating point",
        "periods × samples",
        labelled("energy Σu²", axes.energy_unit),
        labelled("peak", axes.input_unit),
        "crest factor",
        "largest relative error of a line",
    )
    return Table(heads, rows)


def _worst_line(signal: RealisedSignal) -> str:
    """In relation to what was asked; what is left of an exact multisine is rounding, whose digits say nothing."""
    wanted = signal.requested_energies > 0
    error = float(np.abs(signal.achieved_energies[wanted] / signal.requested_energies[wanted] - 1).max())
    return f"below {significant(ROUNDING, 1)}" if error < ROUNDING else significant(error, 1)
