"""Exactness: random stable systems of order 1 to 20, noise-free, from the least number of lines of the theorems.

python -m benchmarks.subspace_exactness [--systems 20] [--output FILE]

[Akcay2008, Theorem 1]: n + 2 equidistant lines, q = n + 1, r = n. [Akcay2008, Theorem 3]: 2n + 1 arbitrary lines,
q = n + 1; once spread over the band, and over four decades in discrete and in continuous time. Inputs and outputs
are one to three each. The error is ‖G_model − G‖/‖G‖ on 500 lines over the same band, other than those used.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from identification.models.system import StateSpace
from identification.subspace.equidistant_subspace import EquidistantSubspace
from identification.subspace.frequency_subspace import FrequencySubspace
from identification.subspace.time_domains import held
from tests.support.state_space import exact, random_system, relative_error, wide_system

LOWEST, HIGHEST = 1e-2, 1e2
ASKED = 1e-8


def main() -> None:
    """Print the largest error of each case, and write the figures as JSON."""
    parser = command_line(__doc__)
    parser.add_argument("--systems", type=int, default=20)
    arguments = parser.parse_args()
    rows = run(range(1, 21), arguments.systems)
    print(f"largest and median relative error of {20 * arguments.systems} systems; asked: {ASKED:.0e}")
    for row in rows:
        print(f"{row['case']:55s} {row['largest']:.1e} (order {row['order']:2d})   {row['median']:.1e}")
    write_json(rows, arguments.output)


def run(orders: range, systems: int) -> list[dict[str, Any]]:
    """The errors of each case over all orders and so many systems of each."""
    found: dict[str, list[tuple[float, int]]] = {}
    for order in orders:
        for number in range(systems):
            for case, error in errors(order, np.random.default_rng([order, number])):
                found.setdefault(case, []).append((error, order))
    return [
        {
            "case": case,
            "largest": max(values)[0],
            "order": max(values)[1],
            "median": float(np.median([error for error, _ in values])),
            "systems": len(values),
        }
        for case, values in found.items()
    ]


def errors(n: int, g: np.random.Generator) -> Iterator[tuple[str, float]]:
    """The error of each case for one random system."""
    inputs, outputs = g.integers(1, 4, 2)
    system = random_system(g, n, inputs, outputs, 1.0)
    between = np.linspace(0.001, 3.14, 500)
    first = EquidistantSubspace(order=n, block_rows=n + 1, block_columns=n)
    second = FrequencySubspace(order=n, block_rows=n + 1)

    def error(method: EquidistantSubspace | FrequencySubspace, plant: StateSpace, omega: Any, others: Any) -> float:
        return float(relative_error(method.estimate(exact(plant, omega)).model, plant, others))

    yield "McKelvey 1, equidistant", error(first, system, np.pi * np.arange(n + 2) / (n + 1), between)
    spread = np.pi * (np.arange(2 * n + 1) + g.uniform(0.05, 0.95, 2 * n + 1)) / (2 * n + 1)
    yield "McKelvey 2, arbitrary", error(second, system, spread, between)
    wide = wide_system(g, n, inputs, outputs, LOWEST, HIGHEST)
    position = (np.arange(2 * n + 1) + g.uniform(0.05, 0.95, 2 * n + 1)) / (2 * n + 1)
    decades, others = LOWEST * (HIGHEST / LOWEST) ** position, np.geomspace(LOWEST, HIGHEST, 500)
    yield "McKelvey 2, four decades, continuous time", error(second, wide, decades, others)
    sampled = held(wide, 0.999 * np.pi / HIGHEST)
    yield "McKelvey 2, four decades, discrete time", error(second, sampled, decades, others)


if __name__ == "__main__":
    main()
