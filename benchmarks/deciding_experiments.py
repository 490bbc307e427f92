"""The experiment that decides between two effects: python -m benchmarks.deciding_experiments --runs 50 --output d.json.

For each pair an ambiguous first experiment on the virtual bench: something is missing, either effect may be it, and
neither has more than 95 % of the weight. Then, at no more energy than the first took, a second one: designed to tell
the two apart, the first repeated, or points, levels and bands drawn at random. Counted is how often the diagnosis of
both experiments together gives the hidden effect more than 95 % of the weight, and how often another one. With
--library every effect of the library may be it, and the design tells the likeliest from all that were announced.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.report.document import Plot, Report, Section, Table
from app.report.page import write
from app.report.style import colour, new_figure
from benchmarks.command import command_line, print_table, write_json
from benchmarks.processes import over
from benchmarks.virtual_bench.bench import PERIOD, SAMPLE_TIME
from benchmarks.virtual_bench.played import Played, energy, records, steady
from benchmarks.virtual_bench.study import MODEL, strengths
from identification.comparison.batch import Batch
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import Diagnosis, diagnose
from identification.effects.library import library
from identification.signals import TimeRecord
from oed.budget import within_energy
from oed.hypothesis import sample_noise_variance
from oed.problem import DesignProblem
from oed.spectra.multisines import Multisines
from oed.suspects import known
from oed.targets.effect_discrimination import EffectDiscrimination

POINTS = np.linspace(-1, 1, 5)
PERIODS, MOST_PERIODS, DRAWS, MOST_RIVALS = 4, 32, 200, 3
NYQUIST = np.pi / SAMPLE_TIME
STRATEGIES = ("designed", "repeated", "random")
VERDICTS = ("right", "wrong", "undecided")


@dataclass(frozen=True)
class Pair:
    """Two effects, how strong they are (times three per cent misfit) and the noise.

    The first experiment plays `level` at `points` in `band`; the second may play `levels` in `bands` at POINTS: where
    none are given, in the whole band up to near the Nyquist frequency and its parts. `hidden`: how many of the two are
    hidden in turn; quadratic damping is never taken for dry friction, whose sign would be wrong.
    """

    effects: tuple[str, str]
    strength: float
    sigma: float
    points: tuple[float, ...]
    level: float
    band: tuple[float, float]
    levels: tuple[float, ...]
    bands: tuple[tuple[float, float], ...] = ()
    share: float = 0.75
    hidden: int = 2
    library: bool = False


def _windows(width: float) -> tuple[tuple[float, float], ...]:
    """Bands of a width beside each other up to near the Nyquist frequency."""
    edges = np.arange(0.2, 0.95 * NYQUIST, width)
    return tuple((float(low), float(low + width)) for low in edges)


LEVELS = (2.5, 5.0, 10.0)
EVERYWHERE = tuple(float(p) for p in POINTS)
PAIRS = (
    Pair(("delay", "lag"), 1.5, 0.03, EVERYWHERE, 20.0, (0.2, 24.6), (10.0, 20.0), _windows(0.5), share=1.0),
    Pair(("quadratic_stiffness", "quadratic_sensor"), 1.0, 0.03, (-0.5, 0.0, 0.5), 10.0, (0.2, 3.0), LEVELS),
    Pair(("coulomb_friction", "quadratic_damping"), 1.0, 0.12, (0.0, 0.5), 10.0, (4.0, 12.0), LEVELS, hidden=1),
)


def first_experiment(pair: Pair) -> list[Played]:
    """A multisine of the same level and band at each point, the phases drawn anew."""
    found = []
    for m, point in enumerate(pair.points):
        family = Multisines(PERIOD, (pair.level,), (pair.band,), seed=100 + m)
        found.append((float(point), replace(family.signals(None, SAMPLE_TIME)[0], periods=PERIODS)))
    return found


def diagnosed(pair: Pair, batches: Sequence[Batch], seed: int) -> Diagnosis:
    """Which of the two it is, if one of them; or which of the whole library."""
    if pair.library:
        return diagnose(MODEL, batches, [one for one in library() if not one.of_measurements], seed=seed, material=0.0)
    return diagnose(MODEL, batches, [known(kind, "effect") for kind in pair.effects], seed=seed, material=0.0)


def decided(found: Diagnosis) -> str:
    """The effect with more than 95 % of the weight, or nothing."""
    return found.best.score.candidate.effect.kind if found.best and found.confident else ""


def ambiguous(found: Diagnosis) -> bool:
    """Whether something is missing, several effects may be it, and none has more than 95 % of the weight."""
    return len(found.announced) >= 2 and found.announced[0].weight <= 0.95


def family_of(pair: Pair) -> Multisines:
    """What the second experiment may play."""
    return Multisines(PERIOD, pair.levels, pair.bands, pair.share, seed=7)


def designed(pair: Pair, found: Diagnosis, batches: tuple[Batch, ...], budget: float) -> list[Played]:
    """The experiments that tell the likeliest effect from the others best, both ways, after what is known."""
    likeliest, *others = dict.fromkeys(one.score.candidate.effect.kind for one in found.announced)
    model = replace(found.base.model, noise_variance=sample_noise_variance(batches[0]))
    problem = DesignProblem(
        model,
        POINTS[:, None],
        tuple(EffectDiscrimination(likeliest, other) for other in others[:MOST_RIVALS]),
        family_of(pair),
        MOST_PERIODS * PERIOD,
        sample_time=SAMPLE_TIME,
        band=(0.2, 0.95 * NYQUIST),
        prior_experiments=batches,
        tolerance=1e-3,
    )
    design = within_energy(problem, budget)
    return [(one.operating_point[0], one.spectrum) for one in design.experiments]


def drawn(pair: Pair, budget: float, generator: np.random.Generator) -> list[Played]:
    """Points, levels and bands at random, four periods each, as long as the energy lasts."""
    signals = family_of(pair).signals((0.2, 0.95 * NYQUIST), SAMPLE_TIME)
    chosen: list[Played] = []
    for _ in range(DRAWS):
        one = replace(signals[generator.integers(len(signals))], periods=PERIODS)
        if energy(chosen) + one.energy <= budget:
            chosen.append((float(generator.choice(POINTS)), one))
    return chosen


def measured(pair: Pair, truth: str, played: Sequence[Played], generator: np.random.Generator) -> list[TimeRecord]:
    """Records of experiments on the bench with the effect hidden."""
    flows = steady(played, ((truth, pair.strength * strengths()[truth]),))
    return records(played, flows, pair.sigma, generator)


def begun_ambiguously(
    pair: Pair, truth: str, first: Sequence[Played], generator: np.random.Generator
) -> tuple[int, list[TimeRecord], tuple[Batch, ...], Diagnosis]:
    """The first experiment measured until it is ambiguous: how often, the records, their batches and diagnosis."""
    flows = steady(first, ((truth, pair.strength * strengths()[truth]),))
    for tried in range(1, DRAWS + 1):
        begun = records(first, flows, pair.sigma, generator)
        batches = gather(begun)
        found = diagnosed(pair, batches, tried)
        if ambiguous(found):
            return tried, begun, batches, found
    raise RuntimeError(f"{DRAWS} first experiments with {truth} hidden, and none was ambiguous")


def one_run(task: tuple[int, str, int, bool]) -> dict[str, Any]:
    """An ambiguous first experiment, and what each strategy makes of it."""
    number, truth, seed, whole = task
    pair = replace(PAIRS[number], library=whole)
    generator = np.random.default_rng([number, pair.effects.index(truth), seed])
    first = first_experiment(pair)
    tried, begun, batches, found = begun_ambiguously(pair, truth, first, generator)
    budget = energy(first)
    plans = {
        "designed": designed(pair, found, batches, budget),
        "repeated": first,
        "random": drawn(pair, budget, generator),
    }
    result: dict[str, Any] = {"pair": " / ".join(pair.effects), "truth": truth, "tried": tried, "budget": budget}
    result["first"] = _weights(found)
    for name, plan in plans.items():
        both = gather([*begun, *measured(pair, truth, plan, generator)])
        last = diagnosed(pair, both, seed)
        decision = decided(last)
        verdict = "undecided" if not decision else "right" if decision == truth else "wrong"
        result[name] = {"verdict": verdict, "energy": energy(plan), "weights": _weights(last), "plan": _plan(plan)}
    return result


def _weights(found: Diagnosis) -> dict[str, float]:
    return {one.score.candidate.effect.kind: one.weight for one in found.evidence}


def _plan(played: Sequence[Played]) -> list[dict[str, Any]]:
    return [
        {
            "operating point": point,
            "level": one.level,
            "band": [float(one.frequencies[0]), float(one.frequencies[-1])],
            "periods": one.periods,
        }
        for point, one in played
    ]


def summary(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Shares of right, wrong and no decisions for each pair and strategy."""
    table: dict[str, Any] = {}
    for pair in dict.fromkeys(run["pair"] for run in runs):
        own = [run for run in runs if run["pair"] == pair]
        table[pair] = {"runs": len(own), "first experiments tried": sum(run["tried"] for run in own)}
        for name in STRATEGIES:
            verdicts = [run[name]["verdict"] for run in own]
            shares = {verdict: verdicts.count(verdict) / len(own) for verdict in VERDICTS}
            spent = float(np.mean([run[name]["energy"] / run["budget"] for run in own]))
            table[pair][name] = {**shares, "energy over budget": spent}
    return table


def picture(table: dict[str, Any]) -> Report:
    """Stacked bars: right, undecided, wrong for every strategy of every pair."""
    cases = [(pair, name) for pair in table for name in STRATEGIES]
    figure = new_figure(height=420)
    for i, verdict in enumerate(VERDICTS):
        shares = [100 * table[pair][name][verdict] for pair, name in cases]
        figure.add_bar(
            x=[f"{pair}<br>{name}" for pair, name in cases], y=shares, name=verdict, marker={"color": colour(i)}
        )
    figure.update_layout(barmode="stack")
    figure.update_yaxes(title="share of the runs (%)")
    rows = tuple((pair, name, *(f"{table[pair][name][verdict]:.0%}" for verdict in VERDICTS)) for pair, name in cases)
    plot = Plot(
        figure, "Decision after the second experiment.", Table(("pair", "second", *VERDICTS), rows, text_columns=2)
    )
    introduction = (
        "From an ambiguous first experiment, with a second one of no more energy; decided is above 95 % weight."
    )
    return Report("The experiment that decides", introduction, sections=(Section("Decisions", blocks=(plot,)),))


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__ or "", runs=50, page=True)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--pair", type=int, choices=range(len(PAIRS)), help="one pair alone")
    parser.add_argument("--library", action="store_true", help="judge by the whole library of effects")
    options = parser.parse_args()
    strengths()
    chosen = range(len(PAIRS)) if options.pair is None else [options.pair]
    every = [(n, r) for n in chosen for r in range(options.runs)]
    tasks = [(n, PAIRS[n].effects[r % PAIRS[n].hidden], r, options.library) for n, r in every]
    runs = over(one_run, tasks, options.workers)
    table = summary(runs)
    print_table([{"pair": pair, "second": name, **rows[name]} for pair, rows in table.items() for name in STRATEGIES])
    write_json({"summary": table, "runs": runs}, options.output)
    if options.page:
        write(picture(table), options.page)


if __name__ == "__main__":
    main()
