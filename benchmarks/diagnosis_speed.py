"""How long one diagnosis takes, by effects, operating points and lines: python -m benchmarks.diagnosis_speed --runs 5.

From 30 effects, 14 records and 200 lines each of the three grows by itself. Prints the median and the 95 % quantile of
wall-clock seconds, and the median of processor seconds, over what is hidden; --output writes JSON, --page HTML.
"""

from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from app.report.style import colour, new_figure
from benchmarks.command import command_line, print_table, write_json
from benchmarks.virtual_bench.study import MODEL, effects
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.signals import TimeRecord

PERIOD, SAMPLE_TIME, PERIODS = 1024, 0.05, 4
USUAL = (30, 7, 200)
GROWTH = {
    "effects": [(count, *USUAL[1:]) for count in (10, 20, 30, 40)],
    "records": [(USUAL[0], points, USUAL[2]) for points in (3, 7, 15, 30)],
    "lines": [(*USUAL[:2], lines) for lines in (50, 100, 200, 400)],
}
HIDDEN = ("nothing", "delay", "quadratic sensor")


class _Points:
    def __init__(self, points: np.ndarray) -> None:
        self.points = points


def records(points: int, lines: int, hidden: str, generator: np.random.Generator) -> list[TimeRecord]:
    """Two records at each operating point, four periods, three per cent noise."""
    k = np.sort(generator.choice(np.arange(1, min(2 * lines, PERIOD // 2 - 8)), lines, replace=False))
    omega = 2 * np.pi * k / (PERIOD * SAMPLE_TIME)
    found = []
    for p in np.repeat(np.linspace(-1, 1, points), 2):
        u = np.exp(2j * np.pi * generator.random(lines)) * 20 * np.sqrt(2 / lines)
        response = MODEL.frequency_response([[p]], omega)[0, :, 0, 0] * (
            np.exp(-0.005j * omega) if hidden == "delay" else 1
        )
        signals = []
        for phasors in (u, response * u):
            spectrum = np.zeros(PERIOD // 2 + 1, dtype=complex)
            spectrum[k] = phasors
            signals.append(np.tile(np.fft.irfft(spectrum * PERIOD / 2, n=PERIOD), PERIODS))
        y = signals[1] + (0.05 * signals[1] ** 2 if hidden == "quadratic sensor" else 0)
        noise = 0.03 * np.std(y) * generator.standard_normal(len(y))
        found.append(TimeRecord(signals[0], y + noise, SAMPLE_TIME, (float(p),), PERIOD))
    return found


def measured(count: int, points: int, lines: int, runs: int) -> dict[str, Any]:
    """Median seconds of a diagnosis with `count` effects."""
    wall, processor = [], []
    for run in range(runs):
        for hidden in HIDDEN:
            batches = gather(records(points, lines, hidden, np.random.default_rng(run)))
            library = effects(_Points(np.repeat(np.linspace(-1, 1, points), 2)))
            chosen = [*(e for e in library if e.kind in ("delay", "quadratic_sensor")), *library][: count + 2]
            chosen = list({one.kind: one for one in chosen}.values())[:count]
            start, used = perf_counter(), process_time()
            diagnose(MODEL, batches, chosen, seed=run)
            wall.append(perf_counter() - start)
            processor.append(process_time() - used)
    return {
        "effects": count,
        "records": 2 * points,
        "lines": lines,
        "median seconds": float(np.median(wall)),
        "median processor seconds": float(np.median(processor)),
        "95 % of seconds": float(np.quantile(wall, 0.95)),
    }


def picture(growth: dict[str, list[dict[str, Any]]], path: Path) -> None:
    """Seconds over each quantity, as an HTML page."""
    figure = new_figure([f"seconds over {name}" for name in growth], height=800)
    figure.update_xaxes(matches=None)
    for row, (name, cases) in enumerate(growth.items(), start=1):
        for i, quantity in enumerate(("median seconds", "95 % of seconds")):
            figure.add_scatter(
                x=[case[name] for case in cases],
                y=[case[quantity] for case in cases],
                name=quantity,
                line={"color": colour(i)},
                showlegend=row == 1,
                row=row,
                col=1,
            )
    figure.write_html(path, include_plotlyjs=True)


def main() -> None:
    """Parses the command line, runs, prints."""
    options = command_line(__doc__, runs=3, page=True).parse_args()
    cases = dict.fromkeys(case for growing in GROWTH.values() for case in growing)
    found = {case: measured(*case, options.runs) for case in cases}
    growth = {name: [found[case] for case in growing] for name, growing in GROWTH.items()}
    print_table([{"growing": name, **row} for name, rows in growth.items() for row in rows])
    write_json(growth, options.output)
    if options.page:
        picture(growth, options.page)


if __name__ == "__main__":
    main()
