"""Consistency: the error of McKelvey 2 against the number of lines, with unequal noise, K from its variances or K = I.

python -m benchmarks.subspace_consistency [--runs 20] [--largest 100000] [--output FILE] [--page FILE.html]

A system of order 4 with two inputs and outputs; noise of 30 % of the root mean square of the response between 1 and
1.6 rad per sample and of 0.6 % elsewhere [Akcay2008, Theorem 4].
"""

from typing import Any

import numpy as np
import plotly.graph_objects as go

from benchmarks.command import command_line, write_json
from identification.subspace.equidistant_subspace import EquidistantSubspace
from identification.subspace.frequency_subspace import FrequencySubspace
from tests.support.state_space import noisy, random_system, relative_error

METHODS = {
    "McKelvey 2, K from the variances": FrequencySubspace(order=4, block_rows=8),
    "McKelvey 2, K = I": FrequencySubspace(order=4, block_rows=8, weighting="none"),
    "McKelvey 1": EquidistantSubspace(order=4, block_rows=8, block_columns=8),
}
SYSTEM = random_system(np.random.default_rng(3), 4, 2, 2, 1.0, radius=(0.6, 0.9))
BETWEEN = np.linspace(0.005, 3.13, 400)


def main() -> None:
    """Print the errors and their slopes, write them as JSON and as a picture."""
    parser = command_line(__doc__, runs=20, page=True)
    parser.add_argument("--largest", type=int, default=100_000)
    arguments = parser.parse_args()
    counts = [int(m) for m in np.round(10 ** np.arange(2, np.log10(arguments.largest) + 0.01, 0.5))]
    result = run(counts, arguments.runs)
    print("lines      " + "  ".join(f"{m:>9d}" for m in counts) + "   slope")
    for row in result["methods"]:
        print(f"{row['method']:33s}" + "  ".join(f"{e:.3e}" for e in row["errors"]) + f"   {row['slope']:+.3f}")
    write_json(result, arguments.output)
    if arguments.page:
        picture(result).write_html(arguments.page, include_plotlyjs=True)


def run(counts: list[int], runs: int) -> dict[str, Any]:
    """Root mean square over the runs of the relative error of the response, and the slope of its logarithm."""
    found = {name: [] for name in METHODS}  # type: dict[str, list[float]]
    for count in counts:
        errors = [list(one(count, np.random.default_rng([count, number])).values()) for number in range(runs)]
        for name, values in zip(METHODS, np.transpose(errors), strict=True):
            found[name].append(float(np.sqrt(np.mean(values**2))))
    rows = [
        {"method": name, "errors": e, "slope": float(np.polyfit(np.log(counts), np.log(e), 1)[0])}
        for name, e in found.items()
    ]
    return {"lines": counts, "runs": runs, "methods": rows}


def one(count: int, g: np.random.Generator) -> dict[str, float]:
    """The relative error of each method on one set of data; all see the same noise level at the same frequencies."""
    irregular = np.pi * (np.arange(count) + g.uniform(0.2, 0.8, count)) / count
    regular = np.pi * np.arange(count) / (count - 1)
    level = np.sqrt(np.mean(abs(SYSTEM.frequency_response(BETWEEN)) ** 2))

    def error(method: Any, omega: Any) -> float:
        deviation = level * np.where((omega > 1.0) & (omega < 1.6), 0.3, 0.006)
        return float(relative_error(method.estimate(noisy(SYSTEM, omega, deviation, g)).model, SYSTEM, BETWEEN))

    return {n: error(m, regular if isinstance(m, EquidistantSubspace) else irregular) for n, m in METHODS.items()}


def picture(result: dict[str, Any]) -> go.Figure:
    """The errors against the number of lines, with the slope of consistency."""
    figure = go.Figure()
    for row in result["methods"]:
        figure.add_scatter(x=result["lines"], y=row["errors"], name=row["method"], mode="lines+markers")
    first = result["methods"][0]["errors"][0]
    guide = [first * np.sqrt(result["lines"][0] / m) for m in result["lines"]]
    figure.add_scatter(x=result["lines"], y=guide, name="1/√M", mode="lines", line={"dash": "dot", "color": "grey"})
    figure.update_xaxes(type="log", title="number of lines M")
    figure.update_yaxes(type="log", title="relative error of the response", exponentformat="power")
    figure.update_layout(template="plotly_white", title="Error against the number of lines, unequal noise")
    return figure


if __name__ == "__main__":
    main()
