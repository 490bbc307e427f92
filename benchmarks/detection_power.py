"""A design that would notice: python -m benchmarks.detection_power --runs 300 --output power.json --page power.html.

Asks for the experiments of least energy that show a cubic stiffness of a stated size with 90 % power in a test at 5 %,
plays them on the virtual bench (Runge–Kutta, its own noise) with that stiffness hidden, with less, with more and with
nothing hidden, and counts how often the score test sees it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from app.report.document import Fact, Plot, Report, Section, Table
from app.report.page import write
from app.report.style import colour, new_figure
from benchmarks.command import command_line, print_table, write_json
from benchmarks.processes import over
from benchmarks.virtual_bench.bench import PERIOD, SAMPLE_TIME
from benchmarks.virtual_bench.figures import rate
from benchmarks.virtual_bench.played import records, steady
from benchmarks.virtual_bench.study import MODEL
from identification.comparison.gather import gather
from identification.diagnosis.scores import score_tests
from identification.diagnosis.signatures import candidates
from identification.effects.cubic_stiffness import CubicStiffness
from identification.extension.fit import fit
from identification.extension.rows import Rows
from oed.decisions import ErrorRates
from oed.design import Design, design
from oed.problem import DesignProblem
from oed.spectra.multisines import Multisines
from oed.targets.effect_detection import EffectDetection

SIGMA, SIZE, POWER, LEVEL = 0.01, 0.02, 0.9, 0.05
SHARES = (0.0, 0.5, 1.0, 1.5)
POINTS = np.linspace(-1, 1, 5)[:, None]
FAMILY = Multisines(PERIOD, levels=(2.0, 4.0, 8.0))
MOST_PERIODS = 64
KNOWN = replace(MODEL, noise_variance=SIGMA**2)


def problem(size: float = SIZE) -> DesignProblem:
    """The least energy that shows a cubic stiffness of this size."""
    target = EffectDetection("cubic_stiffness", size, power=POWER, level=LEVEL)
    band = (2 * np.pi / (PERIOD * SAMPLE_TIME), 0.9 * np.pi / SAMPLE_TIME)
    samples = MOST_PERIODS * PERIOD
    return DesignProblem(KNOWN, POINTS, (target,), FAMILY, samples, sample_time=SAMPLE_TIME, band=band)


def seen(played: Any, flows: Any, seed: int) -> bool:
    """Whether the score test at 5 % sees the stiffness in one measurement of the experiments."""
    batches = gather(records(played, flows, SIGMA, np.random.default_rng(seed)))
    base = fit(MODEL, Rows(batches))
    found = score_tests(base, candidates(base, (CubicStiffness(),)), np.random.default_rng(seed))
    return bool(found[0].p_value < LEVEL)


def _seen(task: tuple[Any, Any, int]) -> bool:
    return seen(*task)


def measured(played: Any, size: float, runs: int, workers: int) -> dict[str, Any]:
    """How often the stiffness is seen with so much of it hidden."""
    flows = steady(played, (("cubic_stiffness", size),) if size else ())
    return rate(over(_seen, [(played, flows, seed) for seed in range(runs)], workers))


def study(runs: int, workers: int) -> dict[str, Any]:
    """The design with its certificate, and the power by the size of what is hidden."""
    found = design(problem())
    played = [(one.operating_point[0], one.spectrum) for one in found.experiments]
    variance, rates = found.decisions[0][1].variance, ErrorRates(POWER, LEVEL)
    sizes = [share * SIZE for share in SHARES]
    return {
        "cubic stiffness": SIZE,
        "noise standard deviation": SIGMA,
        "asked power": POWER,
        "level": LEVEL,
        "least energy": found.least_energy,
        "lower bound": found.lower_bound,
        "certified gap": found.gap,
        "energy of whole periods": found.total_energy,
        "expected standard deviation": float(np.sqrt(variance)),
        "experiments": _described(found),
        "power": [
            {"hidden": size, "expected": rates.power_at(size**2 / variance), **measured(played, size, runs, workers)}
            for size in sizes
        ],
    }


def _described(found: Design) -> list[dict[str, Any]]:
    return [
        {
            "operating point": one.operating_point[0],
            "root mean square of the input": one.spectrum.level,
            "band in rad/s": [float(one.spectrum.frequencies[0]), float(one.spectrum.frequencies[-1])],
            "periods": one.spectrum.periods,
        }
        for one in found.experiments
    ]


def picture(found: dict[str, Any]) -> Report:
    """Expected and measured power over the size of what is hidden."""
    rows: Sequence[dict[str, Any]] = found["power"]
    hidden = [row["hidden"] for row in rows]
    figure = new_figure()
    curve = np.linspace(0, hidden[-1], 60)
    rates, variance = ErrorRates(POWER, LEVEL), found["expected standard deviation"] ** 2
    figure.add_scatter(
        x=curve, y=[100 * rates.power_at(e**2 / variance) for e in curve], name="expected", line={"color": colour(0)}
    )
    ends = np.array([row["interval"] for row in rows])
    percent = np.array([row["percent"] for row in rows])
    figure.add_scatter(
        x=hidden,
        y=percent,
        mode="markers",
        name="measured, 99 % interval",
        marker={"color": colour(1)},
        error_y={"array": ends[:, 1] - percent, "arrayminus": percent - ends[:, 0]},
    )
    figure.update_xaxes(title="cubic stiffness that is hidden")
    figure.update_yaxes(title="seen (%)", range=[0, 102])
    table = Table(
        ("hidden", "expected (%)", "seen (%)", "99 % interval"),
        tuple(
            (
                f"{r['hidden']:g}",
                f"{100 * r['expected']:.1f}",
                f"{r['percent']:.1f}",
                "{:.1f} … {:.1f}".format(*r["interval"]),
            )
            for r in rows
        ),
    )
    facts = (
        Fact(f"{found['least energy']:.6g}", "least energy"),
        Fact(f"{found['lower bound']:.6g}", "certified lower bound"),
    )
    plot = Plot(figure, "How often the score test at 5 % sees the stiffness.", table)
    introduction = (
        f"Designed to see a cubic stiffness of {SIZE:g} with {100 * POWER:g} % power; {rows[0]['of']} runs a point."
    )
    return Report("A design that would notice", introduction, facts, (Section("Power", blocks=(plot,)),))


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__ or "", runs=300, page=True)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    found = study(options.runs, options.workers)
    print_table([{name: value for name, value in found.items() if isinstance(value, float)}])
    print_table(found["power"])
    write_json(found, options.output)
    if options.page:
        write(picture(found), options.page)


if __name__ == "__main__":
    main()
