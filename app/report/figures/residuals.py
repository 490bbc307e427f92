"""What the model leaves unexplained."""

from collections.abc import Sequence

import numpy as np

from app.report.axes import Axes
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import NEUTRAL, colour, new_figure
from identification.arrays import FloatArray
from identification.confidence import QUANTILE_95
from identification.outcome import TestResult
from identification.signals import OperatingPoint

LAGS = 20
SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x")


def residual_correlation(points: Sequence[OperatingPoint], errors: Sequence[FloatArray], axes: Axes) -> Plot:
    """Autocorrelation of the prediction errors of each experiment with the 95 % bounds of white noise."""
    figure = new_figure(height=340)
    correlations = [autocorrelation(error, LAGS) for error in errors]
    lags = np.arange(1, LAGS + 1)
    for i, (point, correlation) in enumerate(zip(points, correlations, strict=True)):
        marker = {"symbol": SYMBOLS[i % len(SYMBOLS)], "size": 7, "color": colour(i)}
        figure.add_scatter(x=lags, y=correlation, mode="markers", marker=marker, name=axes.point(point))
    bound = QUANTILE_95 / np.sqrt(min(len(error) for error in errors))
    for y in (-bound, bound):
        figure.add_hline(y=y, line={"color": NEUTRAL, "dash": "dash"})
    figure.update_xaxes(title="lag (samples)")
    figure.update_yaxes(title="autocorrelation")
    rows = tuple((str(lag), *(significant(c[lag - 1], 2) for c in correlations)) for lag in lags)
    caption = (
        "Autocorrelation of the prediction errors; 95 of 100 lie between the dashed lines when the model is right."
    )
    return Plot(figure, caption, Table(("lag", *(axes.point(point) for point in points)), rows))


def autocorrelation(error: FloatArray, lags: int) -> FloatArray:
    """r_1 … r_lags of a sequence (N,), as (lags,)."""
    return np.array([error[lag:] @ error[:-lag] for lag in range(1, lags + 1)]) / float(error @ error)


def test_table(tests: Sequence[TestResult]) -> Table:
    """Tests of the residuals."""
    heads = ("test", "statistic", "degrees of freedom", "p-value")
    rows = tuple(
        (test.name, significant(test.statistic), significant(test.degrees_of_freedom), significant(test.p_value, 2))
        for test in tests
    )
    return Table(heads, rows, "A p-value below 0.05 comes up in one test of twenty when the model is right.")
