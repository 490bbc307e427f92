"""How the solver closed the gap between the energy of the design and the bound below it."""

from collections.abc import Sequence

import numpy as np

from app.report.axes import Axes, labelled
from app.report.document import Plot, Table
from app.report.numbers import percent, significant
from app.report.style import NEUTRAL, colour, new_figure
from oed.design import Design


def convergence(history: Sequence[tuple[int, float]], tolerance: float) -> Plot:
    """The relative gap after each iteration."""
    figure = new_figure(height=280)
    rounds, gaps = [iteration for iteration, _ in history], [max(gap, 1e-12) for _, gap in history]
    line = {"color": colour(0), "width": 2}
    figure.add_scatter(x=rounds, y=gaps, mode="lines+markers", line=line, showlegend=False)
    figure.add_hline(y=tolerance, line={"color": NEUTRAL, "dash": "dash"})
    figure.update_xaxes(title="iteration", dtick=max(1, len(rounds) // 10))
    low, high = np.log10(min([*gaps, tolerance])), np.log10(max([*gaps, tolerance]))
    figure.update_yaxes(title="relative gap", type="log", range=[np.floor(low), np.ceil(high) + 0.1], dtick=1)
    figure.update_yaxes(exponentformat="power")
    rows = tuple((str(iteration), significant(gap, 2)) for iteration, gap in history)
    caption = "Relative gap between energy and lower bound after each iteration; dashed, the gap asked for."
    return Plot(figure, caption, Table(("iteration", "relative gap"), rows))


def certificate_table(design: Design, axes: Axes, targets: Sequence[str]) -> Table:
    """Primal and dual value, gap, duration, and which of the named targets hold the energy up."""
    energy = axes.energy_unit
    rows = [
        (labelled("energy of the design (primal value)", energy), significant(design.total_energy, 6)),
        (labelled("no design can need less than (dual value)", energy), significant(design.lower_bound, 6)),
        ("relative gap", significant(design.gap, 2)),
        ("samples of each experiment", str(design.samples)),
        ("samples needed for the noise model", significant(design.required_samples, 3)),
    ]
    for binding in design.binding:
        if binding.what == "target" and len(targets) > 1:
            rows.append((f"share of the energy due to: {targets[binding.index]}", percent(binding.multiplier)))
        if binding.what == "cap":
            rows.append((f"energy saved per unit of cap at point {binding.index + 1}", significant(binding.multiplier)))
    return Table(("certificate", "value"), tuple(rows))
