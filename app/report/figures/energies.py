"""Where the input energy goes."""

from collections.abc import Sequence

import numpy as np

from app.report.axes import Axes, labelled
from app.report.document import Plot, Table
from app.report.numbers import percent, significant
from app.report.style import NEUTRAL, colour, new_figure, wrapped
from identification.arrays import FloatArray
from oed.design import DesignedExperiment


def energy_per_point(experiments: Sequence[DesignedExperiment], offered: FloatArray, axes: Axes) -> Plot:
    """Bars of energy over the first scheduling variable, with the operating points (M, s) that were offered."""
    figure = new_figure(height=300)
    places = [experiment.operating_point[0] for experiment in experiments]
    energies = [experiment.energy for experiment in experiments]
    width = np.ptp(offered[:, 0]) / 40
    figure.add_bar(
        x=places,
        y=energies,
        width=width,
        name="designed",
        marker={"color": colour(0)},
        text=[significant(energy) for energy in energies],
        textposition="outside",
        constraintext="none",
        textangle=0,
        cliponaxis=False,
    )
    figure.add_scatter(
        x=offered[:, 0],
        y=np.zeros(len(offered)),
        mode="markers",
        name="offered",
        cliponaxis=False,
        marker={"symbol": "line-ns-open", "size": 9, "color": NEUTRAL},
    )
    margin = 0.03 * float(np.ptp(offered[:, 0]))
    figure.update_xaxes(title=axes.scheduling, range=[offered[:, 0].min() - margin, offered[:, 0].max() + margin])
    figure.update_yaxes(title=labelled("energy Σu²", axes.energy_unit), rangemode="tozero")
    return Plot(figure, "Input energy at each operating point of the design.", energy_table(experiments, axes))


def energy_table(experiments: Sequence[DesignedExperiment], axes: Axes) -> Table:
    """Operating points with their energy and its share."""
    total = sum(experiment.energy for experiment in experiments)
    rows = [(axes.point(e.operating_point), significant(e.energy, 4), percent(e.energy / total)) for e in experiments]
    rows.append(("all", significant(total, 4), "100 %"))
    return Table(("operating point", labelled("energy Σu²", axes.energy_unit), "share"), tuple(rows))


def energy_comparison(alternatives: Sequence[tuple[str, float]], axes: Axes) -> Plot:
    """Bars of the energy that different ways need for the same accuracy, in relation to the first of them."""
    names, energies = [name for name, _ in alternatives], [energy for _, energy in alternatives]
    figure = new_figure(height=110 + 48 * len(names))
    figure.add_bar(
        x=energies,
        y=[wrapped(name) for name in names],
        orientation="h",
        marker={"color": [colour(0)] + [NEUTRAL] * (len(names) - 1)},
        text=[significant(energy, 4) for energy in energies],
        textposition="outside",
        constraintext="none",
        textangle=0,
        cliponaxis=False,
    )
    figure.update_layout(margin={"t": 8})
    figure.update_yaxes(autorange="reversed", showgrid=False)
    figure.update_xaxes(title=labelled("energy Σu²", axes.energy_unit), range=[0, 1.35 * max(energies)], nticks=6)
    rows = tuple((name, significant(e, 4), percent(e / energies[0])) for name, e in alternatives)
    table = Table(("way", labelled("energy Σu²", axes.energy_unit), "relative to the first"), rows)
    return Plot(figure, "Input energy that different ways need for the same accuracy.", table)
