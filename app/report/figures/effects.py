"""Which effects may be missing: evidence, what cannot be told apart, what these experiments could show."""

from collections.abc import Sequence

import numpy as np

from app.report.document import Plot, Table
from app.report.effect_text import amplitude
from app.report.numbers import percent, probability, significant, weight
from app.report.style import NEUTRAL, SEQUENTIAL, colour, new_figure, wrapped
from app.schemas.diagnoses import Diagnosis, EffectVisibility, RankedEffect

MOST_BARS = 8
MOST_CONFUSED = 12
STATUS = {"visible": "visible", "invisible": "invisible", "notJudged": "not judged"}


def ranking(diagnosis: Diagnosis) -> Plot:
    """What each effect that was refitted explains, with its weight; announced ones stand out."""
    best = [one for one in diagnosis.ranking if one.evidence is not None][:MOST_BARS]
    figure = new_figure(height=90 + 44 * max(len(best), 1))
    figure.add_bar(
        x=[one.evidence.chi_square_explained for one in best if one.evidence],
        y=[wrapped(one.title, 26) for one in best],
        orientation="h",
        marker={"color": [colour(0) if one.announced else NEUTRAL for one in best]},
        text=[weight(one.evidence.weight) for one in best if one.evidence],
        textposition="outside",
        cliponaxis=False,
    )
    figure.update_layout(margin={"t": 8})
    figure.update_yaxes(autorange="reversed", showgrid=False)
    most = max((one.evidence.chi_square_explained for one in best if one.evidence), default=1.0)
    figure.update_xaxes(title="explained misfit χ²", range=[0, 1.4 * max(most, 1e-9)], nticks=5)
    caption = (
        "Effects fitted together with the model, best first, with their weights as shares of the evidence (BIC)."
        " In blue those announced: they may be what is missing, and these experiments cannot tell them apart."
    )
    return Plot(figure, caption, ranking_table(diagnosis.ranking))


def ranking_table(ranked: Sequence[RankedEffect]) -> Table:
    """All effects that were judged."""
    heads = (
        "effect",
        "acts",
        "announced",
        "amplitude ± σ",
        "weight",
        "χ² explained per parameter",
        "score",
        "p adjusted",
    )
    rows = tuple(
        (
            one.title,
            one.place,
            "yes" if one.announced else "",
            "–" if one.evidence is None else amplitude(one.evidence.effect),
            "–" if one.evidence is None else weight(one.evidence.weight),
            "–" if one.evidence is None else significant(one.evidence.chi_square_per_parameter),
            significant(one.score),
            probability(one.adjusted_p_value),
        )
        for one in ranked
    )
    return Table(heads, rows, "Refitted effects by evidence, then the others by their score test", text_columns=4)


def confusability(diagnosis: Diagnosis) -> Plot:
    """The squared cosine between the signatures of the first effects of the ranking."""
    count = min(len(diagnosis.ranking), MOST_CONFUSED)
    titles = [one.title for one in diagnosis.ranking]
    values = np.array(diagnosis.confusability)[:count, :count]
    figure = new_figure(height=190 + 30 * count)
    short = [wrapped(title, 20) for title in titles[:count]]
    figure.add_heatmap(
        x=np.arange(count),
        y=np.arange(count),
        z=values,
        zmin=0,
        zmax=1,
        colorscale=SEQUENTIAL,
        colorbar={"thickness": 12, "outlinewidth": 0},
        hovertemplate="%{z:.2f}<extra></extra>",
    )
    ticks = {"tickvals": list(range(count)), "tickmode": "array", "showgrid": False}
    figure.update_xaxes(ticktext=[str(i + 1) for i in range(count)], side="top", **ticks)
    figure.update_yaxes(ticktext=[f"{i + 1} {name}" for i, name in enumerate(short)], autorange="reversed", **ticks)
    caption = (
        "How alike the signatures of two effects are in these experiments, after what the fitted parameters take up:"
        " 1 cannot be told apart, 0 has nothing in common."
    )
    heads = ("effect", *(str(i + 1) for i in range(count)))
    rows = tuple((f"{i + 1} {titles[i]}", *(significant(value, 2) for value in row)) for i, row in enumerate(values))
    return Plot(figure, caption, Table(heads, rows))


def visibility(found: Sequence[EffectVisibility]) -> Plot:
    """The share of the change by each effect that the fitted parameters leave, the least first."""
    ordered = sorted(found, key=lambda one: (one.status != "visible", one.kept))
    seen = [one for one in ordered if one.status == "visible"]
    figure = new_figure(height=120 + 20 * len(seen))
    figure.add_bar(
        x=[100 * one.kept for one in seen],
        y=[one.title for one in seen],
        orientation="h",
        marker={"color": colour(0)},
    )
    figure.update_layout(margin={"t": 8})
    figure.update_yaxes(autorange="reversed", showgrid=False, dtick=1)
    figure.update_xaxes(title="% of its change that the parameters leave", type="log", dtick=1)
    caption = (
        "How much of what each effect changes is left after the fitted parameters have taken up their part; the less,"
        " the harder it is to see in these experiments. Those that cannot be seen at all are in the table."
    )
    heads = ("effect", "status", "why", "detectable amplitude", "share left")
    rows = tuple(
        (
            one.title,
            STATUS[one.status],
            one.reason,
            "–" if one.detectable_amplitude is None else significant(one.detectable_amplitude),
            percent(one.kept),
        )
        for one in ordered
    )
    table = Table(heads, rows, "Amplitudes that a test at 5 % finds with 90 % power", text_columns=3)
    return Plot(figure, caption, table)
