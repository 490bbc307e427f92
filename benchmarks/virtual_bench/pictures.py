"""One page a study: what was found as pictures, with the table behind each."""

from collections.abc import Callable, Sequence
from math import erf
from typing import Any

import numpy as np
import plotly.graph_objects as go

from app.report.document import Fact, Plot, Report, Section, Table
from app.report.numbers import significant
from app.report.style import NEUTRAL, colour, new_figure
from benchmarks.virtual_bench import alarms, hits, unknown

Runs = list[dict[str, Any]]
COMMAND = "python -m benchmarks.diagnosis_study"


def _rate(found: dict[str, Any]) -> str:
    low, high = found["interval"]
    return f"{significant(found['percent'])} % ({significant(low)} … {significant(high)} %)"


def _bars(names: Sequence[str], found: Sequence[dict[str, Any]], axis: str, line: float | None = None) -> go.Figure:
    """Horizontal bars of rates with their 99 % intervals."""
    figure = new_figure(height=90 + 22 * len(names))
    values = np.array([one["percent"] for one in found])
    ends = np.array([one["interval"] for one in found])
    error = {"array": ends[:, 1] - values, "arrayminus": values - ends[:, 0], "color": NEUTRAL, "thickness": 1}
    figure.add_bar(y=list(names), x=values, orientation="h", error_x=error, marker={"color": colour(0)})
    if line is not None:
        figure.add_vline(x=line, line={"color": colour(1), "dash": "dash"})
    figure.update_xaxes(title=axis)
    figure.update_yaxes(autorange="reversed")
    return figure


def alarm_page(runs: Runs, summary: dict[str, Any]) -> Report:
    """Alarm rates, and distribution functions of the p-values."""
    names = list(summary)
    announced = [summary[name]["announced"] for name in names]
    family = [summary[name]["family test below five per cent"] for name in names]
    heads = ("condition", "announced", "family test", "lack of fit below 5 %", "with confidence")
    rows = tuple(
        (
            name,
            _rate(a),
            _rate(f),
            _rate(summary[name]["lack of fit below five per cent"]),
            _rate(summary[name]["announced with confidence"]),
        )
        for name, a, f in zip(names, announced, family, strict=True)
    )
    count = announced[0]["of"]
    caption = f"Something is announced though nothing is hidden, {count} runs a condition; bars are 99 % intervals."
    rates = Plot(_bars(names, announced, "announced (%)", 5.0), caption, Table(heads, rows))
    facts = (
        Fact(f"{max(one['percent'] for one in announced):.1f} %", "most alarms in a condition"),
        Fact(f"{np.mean([one['percent'] for one in announced]):.1f} %", "alarms over all conditions"),
        Fact(f"{len(runs)}", "runs with nothing hidden"),
    )
    sections = (Section("Alarms", blocks=(rates,)), Section("Are the p-values uniform?", blocks=_distributions(runs)))
    return Report("False alarms of the diagnosis", f"{COMMAND} alarms --runs {count}", facts, sections)


def _distributions(runs: Runs) -> tuple[Plot, ...]:
    found = []
    for name, values in (
        ("lack of fit", lambda own: [run["lack of fit p"] for run in own]),
        ("the family of effects", lambda own: [run["family p"] for run in own]),
        ("one effect, drawn at random", alarms.at_random),
    ):
        found.append(_distribution(name, runs, values))
    return tuple(found)


def _distribution(name: str, runs: Runs, values: Callable[[Runs], list[float]]) -> Plot:
    figure = new_figure(height=420)
    levels = np.linspace(0, 1, 101)
    rows = []
    for number in sorted({run["condition"] for run in runs}):
        own = np.sort(values([run for run in runs if run["condition"] == number]))
        share = np.searchsorted(own, levels, side="right") / len(own)
        label = alarms.label(alarms.CONDITIONS[number])
        line = {"color": colour(number), "width": 1}
        figure.add_scatter(x=levels, y=share, mode="lines", line=line, name=label, showlegend=False)
        rows.append((label, *(f"{share[i]:.3f}" for i in (5, 25, 50, 75, 95)), f"{alarms.uniformity(list(own)):.2g}"))
    figure.add_scatter(x=[0, 1], y=[0, 1], mode="lines", line={"color": NEUTRAL, "dash": "dash"}, showlegend=False)
    figure.update_xaxes(title="p")
    figure.update_yaxes(title="share of runs below")
    heads = ("condition", "≤ 0.05", "≤ 0.25", "≤ 0.5", "≤ 0.75", "≤ 0.95", "p of uniformity")
    caption = f"Distribution function of p of {name}, one line a condition; uniform p lie on the dashed line."
    return Plot(figure, caption, Table(heads, tuple(rows)))


def hit_page(runs: Runs, summary: dict[str, Any]) -> Report:
    """Confusion, hit rates of every effect, calibration and errors at each noise level."""
    levels = sorted({run["share"] for run in runs})
    sections = []
    for share, found in zip(levels, summary.values(), strict=True):
        own = [run for run in runs if run["share"] == share]
        blocks = (_measures(found), _confusion(own), _calibration(own), _errors(own))
        sections.append(Section(f"{share:.0%} noise", blocks=blocks))
    first = [one["right effect first"]["percent"] for one in summary.values()]
    facts = tuple(
        Fact(f"{v:.1f} %", f"right effect first at {s:.0%} noise") for s, v in zip(levels, first, strict=True)
    )
    return Report("Hidden effects that are found", f"{COMMAND} hits", facts, tuple(sections))


def _measures(found: dict[str, Any]) -> Table:
    rows = []
    for name, value in found.items():
        if isinstance(value, dict):
            text = _rate(value) if "percent" in value else ", ".join(f"{k}: {significant(v)}" for k, v in value.items())
        else:
            text = str(value) if isinstance(value, int) else _text(value)
        rows.append((name, text))
    return Table(("figure", "value"), tuple(rows), "Rates with 99 % intervals.", text_columns=2)


def _text(value: float | list[str]) -> str:
    return significant(value) if isinstance(value, float) else "; ".join(value) or "none"


def _confusion(runs: Runs) -> Plot:
    kinds = sorted({run["kind"] for run in runs})
    answers = [*kinds, *sorted({run["first"] for run in runs} - set(kinds))]
    counts = np.zeros((len(kinds), len(answers)))
    for run in runs:
        counts[kinds.index(run["kind"]), answers.index(run["first"])] += 1
    share = 100 * counts / counts.sum(axis=1, keepdims=True)
    figure = new_figure(height=240 + 16 * len(kinds))
    bar = {"title": "%", "thickness": 12}
    shown = np.where(share > 0, share, None)
    figure.add_heatmap(
        z=shown, x=answers, y=kinds, zmin=0, zmax=100, colorscale="Viridis", colorbar=bar, xgap=1, ygap=1
    )
    figure.update_xaxes(title="named first", tickangle=90, dtick=1)
    figure.update_yaxes(title="hidden", autorange="reversed", dtick=1)
    rows = []
    for kind, row in zip(kinds, counts, strict=True):
        named = [f"{answers[j]} {int(row[j])}" for j in np.argsort(-row) if row[j]]
        own = hits.by_kind(runs, kind)
        inside = sum(kind in run["set"] for run in own)
        rows.append((kind, str(len(own)), ", ".join(named), str(inside)))
    heads = ("hidden", "runs", "named first", "in the announced set")
    return Plot(figure, "Which effect is named first.", Table(heads, tuple(rows)))


def _calibration(runs: Runs) -> Plot:
    z = np.sort([value for run in runs for value in run.get("z", [])])
    figure = new_figure(height=320)
    grid = np.linspace(-4, 4, 161)
    figure.add_scatter(
        x=grid, y=np.searchsorted(z, grid) / len(z), mode="lines", line={"color": colour(0)}, name="runs"
    )
    normal = [0.5 * (1 + erf(x / np.sqrt(2))) for x in grid]
    figure.add_scatter(x=grid, y=normal, mode="lines", line={"color": NEUTRAL, "dash": "dash"}, name="normal")
    figure.update_xaxes(title="(amplitude − truth)/standard error")
    figure.update_yaxes(title="share of runs below")
    kinds = sorted({run["kind"] for run in runs})
    own = [(kind, np.array([v for run in hits.by_kind(runs, kind) for v in run.get("z", [])])) for kind in kinds]
    rows = tuple(
        (kind, str(len(v)), f"{100 * np.mean(abs(v) < hits.QUANTILE):.0f}", f"{v.mean():.2f}", f"{v.std():.2f}")
        for kind, v in own
        if len(v)
    )
    heads = ("effect", "amplitudes", "% in the 95 % interval", "mean", "standard deviation")
    return Plot(figure, "Errors of the added amplitudes over their stated standard errors.", Table(heads, rows))


def _errors(runs: Runs) -> Plot:
    kinds = sorted({run["kind"] for run in runs if "error after" in run})
    figure = new_figure(height=120 + 18 * len(kinds))
    rows = []
    for i, name in enumerate(("error before", "error after", "error of the true structure")):
        own = [[run[name] for run in hits.by_kind(runs, kind) if name in run] for kind in kinds]
        values = [100 * float(np.median(one)) if one else None for one in own]
        symbol = {"color": colour(i), "symbol": ("circle", "square", "circle-open")[i], "size": (8, 7, 13)[i]}
        figure.add_scatter(x=values, y=kinds, mode="markers", marker=symbol, name=name.removeprefix("error "))
        rows.append(values)
    figure.update_xaxes(type="log", title="held-out error (% of the output)")
    figure.update_yaxes(autorange="reversed", dtick=1)
    numbers = [[f"{kind}", *(significant(row[i]) if row[i] else "–" for row in rows)] for i, kind in enumerate(kinds)]
    table = Table(("effect", "before (%)", "after (%)", "true structure (%)"), tuple(tuple(one) for one in numbers))
    caption = "Median error at operating points, levels and lines that were not fitted, before and after adding."
    return Plot(figure, caption, table)


def pair_page(runs: Runs, summary: dict[str, Any]) -> Report:
    """The staircase of every pair on data that were not fitted."""
    figure = new_figure(height=420)
    for run in runs:
        errors = 100 * np.array(run["held-out errors"])
        shade = colour(0 if run["both found"] else 1)
        names = ["nothing", *run["found"]]
        figure.add_scatter(
            x=list(range(len(errors))), y=errors, text=names, mode="lines", line={"color": shade, "width": 1},
            name=" + ".join(run["hidden"]), showlegend=False,
        )  # fmt: skip
    figure.update_xaxes(title="effects added", dtick=1)
    figure.update_yaxes(type="log", title="held-out error (% of the output)")
    rows = tuple(
        (" + ".join(r["hidden"]), " + ".join(r["found"]), f"{r['p']:.2g}", *(_ends(r["held-out errors"]))) for r in runs
    )
    heads = ("hidden", "found", "p of the lack of fit left", "error before (%)", "after (%)")
    caption = "Error on data that were not fitted; the second colour where one of the two was not found."
    blocks = (_measures(summary), Plot(figure, caption, Table(heads, rows, text_columns=2)))
    facts = (Fact(_rate(summary["both found"]), "both found"),)
    introduction = f"{COMMAND} pairs --runs {len(runs)}"
    return Report("Two hidden effects at once", introduction, facts, (Section("Pairs", blocks=blocks),))


def _ends(errors: Sequence[float]) -> tuple[str, str]:
    return significant(100 * errors[0]), significant(100 * errors[-1])


def unknown_page(runs: Runs, summary: dict[str, Any]) -> Report:
    """What is said of effects that the library does not hold, and whether the picture shows them."""
    each = summary["each"]
    kinds = list(each)
    found = [each[kind]["not in the library"] for kind in kinds]
    names = ("correlation of the response", "correlation of the map", "share of the response in what is missing")
    rows = []
    for kind, f in zip(kinds, found, strict=True):
        medians = [significant(each[kind][name]["median"]) for name in names]
        rows.append((kind, _rate(f), _rate(each[kind]["a wrong effect with confidence"]), *medians))
    heads = ("removed", "not in the library", "wrong with confidence", *names)
    bars = Plot(_bars(kinds, found, "“not in the library” (%)", 90.0), "What is said.", Table(heads, tuple(rows)))
    figure = new_figure(height=320)
    for i, name in enumerate(names[:2]):
        for kind in kinds:
            values = [run[name] for run in runs if run["kind"] == kind]
            figure.add_box(x=[kind] * len(values), y=values, name=name, marker={"color": colour(i)}, showlegend=False)
    figure.update_yaxes(title="correlation with the truth", range=[0, 1.02])
    added = tuple((kind, "; ".join(each[kind]["added"])) for kind in kinds)
    caption = "Of the smooth response that is missing (first colour), and of the map by record, band and line class."
    shape = Plot(figure, caption, Table(("removed", "what was tried instead"), added, text_columns=2))
    facts = (
        Fact(
            _rate(summary["unlike others"]["not in the library"]), "of five unlike others called “not in the library”"
        ),
        Fact(
            f"{len(summary['explained by a relation'])} of {len(kinds)}", "effects have a near relation in the library"
        ),
    )
    introduction = f"{COMMAND} unknown --runs {len(runs) // len(kinds)}"
    shown = Section("The smooth picture in one run", blocks=tuple(_missing(kind) for kind in unknown.UNLIKE_OTHERS))
    sections = (Section("What is said", blocks=(bars,)), Section("Its shape", blocks=(shape,)), shown)
    return Report("Effects that the library does not hold", introduction, facts, sections)


def _missing(kind: str) -> Plot:
    points, frequencies, found, true = unknown.pictures(kind)
    figure = new_figure(("found", "true"), height=460)
    names = [f"p = {p:.2g}, {'low' if i % 2 else 'high'}" for i, p in enumerate(points)]
    for row, values in enumerate((found, true), 1):
        scale = {"zmin": 0, "zmax": float(true.max()), "colorscale": "Viridis", "showscale": row == 1}
        figure.add_heatmap(x=frequencies, y=names, z=values, row=row, col=1, **scale)
    figure.update_xaxes(type="log")
    figure.update_xaxes(title="frequency (rad/s)", row=2)
    columns = np.linspace(0, len(frequencies) - 1, 7).astype(int)
    heads = ("record", *(f"{frequencies[i]:.3g} rad/s" for i in columns))
    rows = (
        (name, *(f"{significant(f[i], 2)} / {significant(t[i], 2)}" for i in columns))
        for name, f, t in zip(names, found, true, strict=True)
    )
    caption = f"|δG| that is missing with {kind} hidden, by operating point and level; the table has found / true."
    return Plot(figure, caption, Table(heads, tuple(rows)))


PAGES: dict[str, Callable[[Runs, dict[str, Any]], Report]] = {
    "hits": hit_page,
    "alarms": alarm_page,
    "pairs": pair_page,
    "unknown": unknown_page,
}
