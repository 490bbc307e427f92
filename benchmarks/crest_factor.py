"""Crest factors of designed multisines against random and Schroeder phases: python -m benchmarks.crest_factor.

Prints a table; --output writes JSON. Times are in units of the time that the best of 1000 random draws of phases takes
in the same run.
"""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from identification.arrays import FloatArray, IntArray
from oed.realisation import crest_factor, multisine, signal_line_energies
from oed.realisation.descent import schroeder_phases
from oed.realisation.lines import Lines, designed_lines

DRAWS = 1000
SEED = 2018
WIDTHS = (30, 6, 8, 8, 9, 9, 9, 11, 8, 9)
HEADINGS = ("lines", "K", "N", "crest", "between", "random", "gain %", "Schroeder", "time", "error")


def flat(index: IntArray) -> tuple[IntArray, FloatArray]:
    """Equal energies."""
    return index, np.ones(len(index))


def drawn(count: int, samples: int, decades: float) -> tuple[IntArray, FloatArray]:
    """Lines drawn from the whole band, with energies over so many decades."""
    random = np.random.default_rng(count)
    index = np.sort(random.choice(samples // 2 + 1, count, replace=False))
    return index, 10.0 ** -random.uniform(0.0, decades, count)


def rational(samples: int) -> tuple[IntArray, FloatArray]:
    """All lines, with the spectrum of a moving average that touches zero."""
    index = np.arange(samples // 2 + 1)
    omega = 2.0 * np.pi * index / samples
    return index, np.maximum((1.0 + np.cos(omega)) * (1.0 - 0.9 * np.cos(omega - 0.4)) ** 2, 0.0)


CASES: dict[str, tuple[int, Callable[[], tuple[IntArray, FloatArray]]]] = {
    "flat, 1..20": (256, lambda: flat(np.arange(1, 21))),
    "flat, 1..20, long": (1000, lambda: flat(np.arange(1, 21))),
    "flat, 0..20": (1000, lambda: flat(np.arange(21))),
    "flat, 20 odd": (1000, lambda: flat(np.arange(1, 41, 2))),
    "flat, 1..50": (256, lambda: flat(np.arange(1, 51))),
    "flat, 1..200": (1000, lambda: flat(np.arange(1, 201))),
    "flat, 1..1000": (4096, lambda: flat(np.arange(1, 1001))),
    "flat, all": (1000, lambda: flat(np.arange(501))),
    "flat, 1..5000": (100_000, lambda: flat(np.arange(1, 5001))),
    "flat, band 50..69": (1000, lambda: flat(np.arange(50, 70))),
    "flat, band 500..699": (5000, lambda: flat(np.arange(500, 700))),
    "flat, 24 over the whole band": (1000, lambda: flat(np.unique(np.linspace(1, 499, 24).astype(int)))),
    "flat, 36 logarithmic": (1000, lambda: flat(np.unique(np.geomspace(1, 400, 45).astype(int)))),
    "one line": (1000, lambda: flat(np.array([7]))),
    "two lines": (1000, lambda: flat(np.array([41, 113]))),
    "ω = 0 and one line": (1000, lambda: flat(np.array([0, 113]))),
    "three lines, 1 decade": (1000, lambda: drawn(3, 1000, 1.0)),
    "six lines, 2 decades": (1000, lambda: drawn(6, 1000, 2.0)),
    "40 lines, 3 decades": (1000, lambda: drawn(40, 1000, 3.0)),
    "smooth spectrum, all": (1000, lambda: rational(1000)),
    "smooth spectrum, all, long": (20_000, lambda: rational(20_000)),
}


def best_random(lines: Lines, generator: np.random.Generator) -> float:
    """The lowest peak of the random draws, computed in portions that fit into memory."""
    portion = max(1, 1_000_000 // lines.samples)
    peaks = []
    for start in range(0, DRAWS, portion):
        phases = generator.uniform(0.0, 2.0 * np.pi, (min(portion, DRAWS - start), len(lines.indices)))
        peaks.append(np.abs(lines.signal(phases)).max(axis=-1).min())
    return float(min(peaks))


def measured(name: str) -> dict[str, Any]:
    """One row of the table."""
    samples, case = CASES[name]
    index, energies = case()
    lines = designed_lines(index, energies, samples)
    start = perf_counter()
    signal = multisine(index, energies, samples, np.random.default_rng(SEED))
    optimised = perf_counter()
    random = best_random(lines, np.random.default_rng(SEED + 1)) / lines.rms
    finished = perf_counter()
    strong = energies > 1e-12 * energies.max()
    achieved = signal_line_energies(signal)[index[strong]]
    crest = crest_factor(signal)
    return {
        "name": name,
        "lines": len(lines.indices),
        "samples": samples,
        "crestFactor": crest,
        "crestFactorBetweenSamples": crest_factor(signal, 8),
        "bestOfRandom": random,
        "gainPercent": 100.0 * (random / crest - 1.0),
        "schroeder": float(np.abs(lines.signal(schroeder_phases(lines))).max()) / lines.rms,
        "timeRatio": (optimised - start) / (finished - optimised),
        "seconds": optimised - start,
        "largestRelativeError": float(np.abs(achieved / energies[strong] - 1.0).max()),
    }


def printed(row: dict[str, Any]) -> str:
    """A row as text."""
    cells = [row["name"], str(row["lines"]), str(row["samples"])]
    cells += [f"{row[key]:.3f}" for key in ("crestFactor", "crestFactorBetweenSamples", "bestOfRandom")]
    cells += [f"{row['gainPercent']:.2g}", f"{row['schroeder']:.3f}", f"{row['timeRatio']:.1f}"]
    return aligned([*cells, f"{row['largestRelativeError']:.0e}"])


def aligned(cells: list[str]) -> str:
    """Cells in columns, the first to the left."""
    first, *others = zip(cells, WIDTHS, strict=True)
    return first[0].ljust(first[1]) + "".join(cell.rjust(width) for cell, width in others)


def main() -> None:
    """The whole table, about half a minute."""
    options = command_line(__doc__).parse_args()
    print(aligned(list(HEADINGS)))
    rows = []
    for name in CASES:
        rows.append(measured(name))
        print(printed(rows[-1]), flush=True)
    write_json({"draws": DRAWS, "seed": SEED, "rows": rows}, options.output)


if __name__ == "__main__":
    main()
