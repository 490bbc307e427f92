"""Times of the subspace method against Algorithm 2 as written (dense QR, loops over lines), in one run, and its growth.

python -m benchmarks.subspace_speed [--runs 5] [--largest 1000000] [--processor] [--output FILE]

With `--processor` the times are those of the processor instead of the wall clock, for a machine that others use too
(set OMP_NUM_THREADS=1 then).
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.command import command_line, timed, write_json
from identification.signals import FrequencyResponse
from identification.subspace.frequency_subspace import FrequencySubspace
from tests.support.literal_subspace import literal_subspace
from tests.support.state_space import random_system

Clock = Callable[[], float]

CASES = (
    {"lines": 3200, "order": 2, "inputs": 1, "outputs": 1, "block_rows": 10, "reference_ms": 179.0},
    {"lines": 800, "order": 20, "inputs": 2, "outputs": 8, "block_rows": 21, "reference_ms": 178.0},
)


def main() -> None:
    """Print the two comparisons and the growth with the number of lines, and write the figures as JSON."""
    parser = command_line(__doc__, runs=5)
    parser.add_argument("--largest", type=int, default=1_000_000)
    parser.add_argument("--processor", action="store_true")
    arguments = parser.parse_args()
    clock = time.process_time if arguments.processor else time.perf_counter
    compared = [compare(clock=clock, runs=arguments.runs, **case) for case in CASES]
    print("lines  n  in out   q      fast     as written   ratio    10 times faster than the reference needs   errors")
    for row in compared:
        print(
            f"{row['lines']:5d} {row['order']:2d} {row['inputs']:3d} {row['outputs']:3d} {row['blockRows']:3d}"
            f" {row['milliseconds']:8.2f} ms {row['asWrittenMilliseconds']:8.0f} ms {row['ratio']:7.1f}"
            f"    {row['referenceMilliseconds'] / 10:5.1f} ms: {row['timesFasterThanReference']:.1f} times"
            f"    {row['error']:.2e} against {row['asWrittenError']:.2e}"
        )
    sizes = [int(x) for x in 10 ** np.arange(3, np.log10(arguments.largest) + 0.01, 0.5)]
    growing = [growth(size, max(arguments.runs - 2, 1), clock) for size in sizes]
    exponent = float(
        np.polyfit(np.log([g["lines"] for g in growing[2:]]), np.log([g["seconds"] for g in growing[2:]]), 1)[0]
    )
    for row in growing:
        print(
            f"{row['lines']:8.0f} lines  {1e3 * row['seconds']:9.2f} ms"
            f"  {1e6 * row['seconds'] / row['lines']:6.2f} µs a line"
        )
    print(f"time grows as lines^{exponent:.2f}")
    write_json({"comparison": compared, "growth": growing, "exponent": exponent}, arguments.output)


def measured(lines: int, order: int, inputs: int, outputs: int) -> tuple[Any, FrequencyResponse]:
    """A random system and its response at irregular frequencies with 1 % noise."""
    g = np.random.default_rng([lines, order])
    system = random_system(g, order, inputs, outputs, 1.0)
    omega = np.pi * (np.arange(lines) + g.uniform(0.2, 0.8, lines)) / lines
    truth = system.frequency_response(omega)
    scale = 0.01 * np.sqrt(np.mean(abs(truth) ** 2) / 2)
    noise = scale * (g.standard_normal((2, *truth.shape)).T @ [1, 1j]).T
    return system, FrequencyResponse(omega, truth + noise, (0.0,), 1.0)


def compare(
    lines: int, order: int, inputs: int, outputs: int, block_rows: int, reference_ms: float, runs: int, clock: Clock
) -> dict[str, Any]:
    """Both by turns on the same data; the error is that of the response against the truth."""
    system, data = measured(lines, order, inputs, outputs)
    method = FrequencySubspace(order=order, block_rows=block_rows)

    def fast() -> Any:
        return method.estimate(data).model

    def slow() -> Any:
        return literal_subspace(data.frequencies, data.response, 1.0, order, block_rows)

    truth = system.frequency_response(data.frequencies)
    errors = [
        np.linalg.norm(f().frequency_response(data.frequencies) - truth) / np.linalg.norm(truth) for f in (fast, slow)
    ]
    pairs = [(timed(fast, clock), timed(slow, clock)) for _ in range(runs)]
    seconds = statistics.median(f for f, _ in pairs)
    return {
        "lines": lines,
        "order": order,
        "inputs": inputs,
        "outputs": outputs,
        "blockRows": block_rows,
        "milliseconds": 1e3 * seconds,
        "asWrittenMilliseconds": 1e3 * statistics.median(s for _, s in pairs),
        "ratio": statistics.median(s / f for f, s in pairs),
        "referenceMilliseconds": reference_ms,
        "timesFasterThanReference": reference_ms / (1e3 * seconds),
        "error": float(errors[0]),
        "asWrittenError": float(errors[1]),
    }


def growth(lines: int, runs: int, clock: Clock) -> dict[str, float]:
    """The median time at a number of lines, one input and output, n = 2, q = 10."""
    _, data = measured(lines, 2, 1, 1)
    method = FrequencySubspace(order=2, block_rows=10)
    return {
        "lines": lines,
        "seconds": statistics.median(timed(lambda: method.estimate(data), clock) for _ in range(runs)),
    }


if __name__ == "__main__":
    main()
