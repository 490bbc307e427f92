"""Designed input spectra."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import plotly.graph_objects as go

from app.report.axes import FREQUENCY, Axes, hertz, labelled
from app.report.document import Plot, Table
from app.report.numbers import significant
from app.report.style import colour, dash, new_figure
from oed.design import DesignedExperiment
from oed.spectra.fir import FirSpectrum
from oed.spectra.lines import LineSpectrum
from oed.spectra.multisines import MultisineSpectrum

POINTS = 301


def spectra(experiments: Sequence[DesignedExperiment], samples: int, sample_time: float, axes: Axes) -> Plot:
    """The spectrum of each experiment over frequency: a curve where it has a density, lines otherwise."""
    figure = new_figure(height=360)
    for i, experiment in enumerate(experiments):
        name = axes.point(experiment.operating_point)
        if isinstance(experiment.spectrum, FirSpectrum):
            _add_density(figure, experiment.spectrum, sample_time, name, i)
        else:
            _add_lines(figure, experiment, samples, sample_time, name, i)
    figure.update_xaxes(title=FREQUENCY, range=[0, 0.5 / sample_time])
    smooth = all(isinstance(experiment.spectrum, FirSpectrum) for experiment in experiments)
    figure.update_yaxes(title=labelled("NΦ" if smooth else "energy", axes.energy_unit), rangemode="tozero")
    caption = "Spectrum of the input at each operating point: " + (
        "N times the power density Φ, whose mean over all frequencies is the energy."
        if smooth
        else "energy of each line."
    )
    return Plot(figure, caption, _table(experiments, samples, sample_time, axes))


def _add_density(figure: go.Figure, spectrum: FirSpectrum, sample_time: float, name: str, i: int) -> None:
    omega = np.linspace(0, np.pi / sample_time, POINTS)
    line = {"color": colour(i), "dash": dash(i), "width": 2.2}
    figure.add_scatter(x=hertz(omega), y=spectrum.density(omega), name=name, mode="lines", line=line)


def _add_lines(
    figure: go.Figure, experiment: DesignedExperiment, samples: int, sample_time: float, name: str, i: int
) -> None:
    period = _period(experiment, samples)
    indices, energies = experiment.spectrum.line_energies(period, sample_time)
    frequencies = indices / (period * sample_time)
    error = {"type": "data", "symmetric": False, "array": 0 * energies, "arrayminus": energies, "width": 0}
    figure.add_scatter(x=frequencies, y=energies, name=name, mode="markers", error_y=error, marker={"color": colour(i)})


def _period(experiment: DesignedExperiment, samples: int) -> int:
    """The samples whose lines hold the spectrum: those of its own period, where it has one."""
    spectrum = experiment.spectrum
    return spectrum.samples if isinstance(spectrum, LineSpectrum | MultisineSpectrum) else samples


def _table(experiments: Sequence[DesignedExperiment], samples: int, sample_time: float, axes: Axes) -> Table:
    """Energy in ten bands of equal width."""
    edges = np.linspace(0, 0.5 / sample_time, 11)
    bands = [f"{significant(low)} to {significant(high)}" for low, high in pairwise(edges)]
    columns = []
    for experiment in experiments:
        period = _period(experiment, samples)
        indices, energies = experiment.spectrum.line_energies(period, sample_time)
        band = np.minimum(20 * indices // period, 9)
        columns.append([significant(value) for value in np.bincount(band, energies, minlength=10)])
    rows = tuple((name, *values) for name, *values in zip(bands, *columns, strict=True))
    heads = tuple(axes.point(experiment.operating_point) for experiment in experiments)
    return Table(("band (Hz)", *heads), rows, labelled("Energy Σu² by band", axes.energy_unit))
