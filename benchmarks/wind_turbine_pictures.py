"""Pictures of the wind turbine study: histograms of VAF, clouds of eigenvalues with their Cramér–Rao ellipses."""

from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots
from scipy.stats import chi2

from identification.arrays import ComplexArray, FloatArray

COLOURS = ("#1f77b4", "#2ca02c", "#ff7f0e")


@dataclass(frozen=True, eq=False)
class Cloud:
    """Of the runs of a method: VAF (n,) in %, eigenvalues (n, 3), and the Cramér–Rao covariances (3, 2, 2) of these."""

    fits: FloatArray
    eigenvalues: ComplexArray
    covariances: FloatArray


def pictures(clouds: dict[str, Cloud], truth: ComplexArray, noise: float) -> go.Figure:
    """All histograms on one axis, as in [Goos2014, Figure 4]; below, for each method, its clouds, as in Figure 5."""
    titles = ["variance accounted for on validation data"]
    for name in clouds:
        titles += [f"{name}: an eigenvalue of A₀", f"{name}: both eigenvalues of A₁"]
    layout = [[{"colspan": 2}, None], *([{}, {}] for _ in clouds)]
    rows = len(layout)
    figure = make_subplots(rows=rows, cols=2, specs=layout, subplot_titles=titles, vertical_spacing=0.2 / rows)
    lowest = min(np.quantile(cloud.fits, 0.005) for cloud in clouds.values())
    bins = {"start": float(lowest), "end": 100.0, "size": float(100 - lowest) / 100}
    for row, ((name, cloud), colour) in enumerate(zip(clouds.items(), COLOURS, strict=False), start=2):
        figure.add_histogram(
            x=cloud.fits, xbins=bins, name=name, opacity=0.6, marker_color=colour, showlegend=True, row=1, col=1
        )
        _complex(figure, cloud, complex(truth[0]), colour, row)
        _real(figure, cloud, truth[1:].real, colour, row)
    figure.update_xaxes(title="VAF in %", row=1, col=1)
    figure.update_yaxes(title="runs", row=1, col=1)
    figure.update_layout(
        template="plotly_white",
        barmode="overlay",
        height=520 * rows,
        width=1300,
        legend={"x": 0.02, "y": 0.99, "yanchor": "top"},
        title=f"standard deviation of the noise {noise:g}; black: truth with the 95 % Cramér–Rao ellipse or intervals",
    )
    return figure


def _complex(figure: go.Figure, cloud: Cloud, truth: complex, colour: str, row: int) -> None:
    x, y = ellipse(truth, cloud.covariances[0])
    values = cloud.eigenvalues[:, 0]
    marks = {"size": 3, "opacity": 0.5, "color": colour}
    figure.add_scatter(x=values.real, y=values.imag, mode="markers", marker=marks, showlegend=False, row=row, col=1)
    figure.add_scatter(x=x, y=y, mode="lines", line_color="black", showlegend=False, row=row, col=1)
    figure.add_scatter(x=[truth.real], y=[truth.imag], marker=CROSS, showlegend=False, row=row, col=1)
    figure.update_xaxes(title="Re λ", row=row, col=1)
    figure.update_yaxes(title="Im λ", row=row, col=1)


def _real(figure: go.Figure, cloud: Cloud, truth: FloatArray, colour: str, row: int) -> None:
    values = cloud.eigenvalues[:, 1:].real
    half = np.sqrt(chi2.ppf(0.95, 1) * cloud.covariances[1:, 0, 0])
    marks = {"size": 3, "opacity": 0.5, "color": colour}
    figure.add_scatter(x=values[:, 0], y=values[:, 1], mode="markers", marker=marks, showlegend=False, row=row, col=2)
    figure.add_scatter(x=[truth[0]], y=[truth[1]], marker=CROSS, showlegend=False, row=row, col=2)
    for sign in (-1, 1):
        figure.add_vline(float(truth[0] + sign * half[0]), line_width=1, row=row, col=2)
        figure.add_hline(float(truth[1] + sign * half[1]), line_width=1, row=row, col=2)
    figure.update_xaxes(title="λ₁", row=row, col=2)
    figure.update_yaxes(title="λ₂", row=row, col=2)


CROSS = {"symbol": "cross-thin-open", "size": 16, "color": "black"}


def ellipse(centre: complex, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The 95 % ellipse as a curve."""
    angle = np.linspace(0, 2 * np.pi, 200)
    curve = np.sqrt(chi2.ppf(0.95, 2)) * np.linalg.cholesky(covariance) @ np.stack([np.cos(angle), np.sin(angle)])
    return curve[0] + centre.real, curve[1] + centre.imag
