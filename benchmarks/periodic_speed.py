"""How long does one iteration of the periodic likelihood take, and how much do small blocks of lines save?

    python -m benchmarks.periodic_speed [--repeats 50] [--dense-repeats 3] [--output FILE]

The wind turbine of [Goos2014, Section 5]: 50 000 samples, 99 periods of 500 kept. An iteration is the residual, its
Jacobian in the chart, and a Levenberg–Marquardt step. It is held in the same run against two dense implementations of
(18)–(19) over the 500 lines: as written, with α, β, γ, δ and the Toeplitz matrices μ formed and multiplied, and a
careful one that assembles Σ μ_i ⊗ A_i directly; both solve for X and for its derivatives with one factorisation. Asked
for are ≤ 20 ms an iteration and 100 times faster than dense. Then the growth with P, T, n_x and n_p, and what blocks of
T n_x unknowns take where the period is run through in time.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from benchmarks.affine_plant import with_constant
from benchmarks.command import command_line, print_table, timed, write_json
from benchmarks.wind_turbine_plant import PLANT, SIZES, THETA, disturbed, noise_free
from identification.arrays import ComplexArray, FloatArray
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.harmonic_noise import HarmonicNoise
from identification.varying.periodic_residuals import PeriodicResiduals
from identification.varying.records import steady_periods
from identification.varying.stacks import StackSizes

Response = Callable[[FloatArray], tuple[ComplexArray, ComplexArray]]


def median_seconds(run: Callable[[], object], repeats: int) -> float:
    """The median time of a call."""
    run()
    return float(np.median([timed(run) for _ in range(repeats)]))


def step(residual: FloatArray, jacobian: FloatArray) -> FloatArray:
    """A damped Gauss–Newton step from a triangular factor."""
    triangle = np.linalg.qr(np.column_stack([jacobian, residual]), mode="r")
    n = jacobian.shape[1]
    damped = np.vstack([triangle[:n, :n], 1e-3 * np.diag(np.diag(triangle[:n, :n]))])
    return np.linalg.lstsq(damped, np.concatenate([-triangle[:n, n], np.zeros(n)]), rcond=None)[0]


def iteration(residuals: PeriodicResiduals, theta: FloatArray, chart: FloatArray) -> FloatArray:
    """One iteration in blocks."""
    residual, jacobian = residuals(theta)
    return step(residual, jacobian @ chart)


class Dense:
    """(18)–(19) over all P lines at once."""

    def __init__(self, blocks: HarmonicBlocks, as_written: bool) -> None:
        self.blocks, self.as_written = blocks, as_written
        weights = np.concatenate([np.ones((blocks.period, 1)), blocks.scheduling], axis=1)
        k = np.arange(blocks.period)
        spectra = np.fft.fft(weights, axis=0).T / blocks.period
        self.toeplitz = spectra[:, (k[:, None] - k) % blocks.period]
        self.input = blocks.extended_input
        self.z = np.exp(2j * np.pi * k / blocks.period)

    def coupled(self, stack: FloatArray) -> ComplexArray:
        """Σ μ_i ⊗ M_i, or α μ_x with both factors formed."""
        if not self.as_written:
            return np.asarray(sum(np.kron(mu, part) for mu, part in zip(self.toeplitz, stack, strict=True)))
        columns = np.concatenate([np.kron(mu, np.eye(stack.shape[2])) for mu in self.toeplitz])
        row = np.concatenate([np.kron(np.eye(self.blocks.period), part) for part in stack], axis=1)
        return np.asarray(row @ columns)

    def __call__(self, theta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Y (P, n_y) and ∂Y/∂θ (P, n_y, size)."""
        sizes, period = self.blocks.sizes, self.blocks.period
        a, b, c, d = sizes.split(theta)
        n, n_y = sizes.order, sizes.n_outputs
        factor = lu_factor(np.kron(np.diag(self.z), np.eye(n)) - self.coupled(a))
        x = lu_solve(factor, np.einsum("kmj,mnj->kn", self.input, b).reshape(-1)).reshape(period, n)
        scheduled = np.einsum("mkl,ln->kmn", self.toeplitz, x)
        output = np.einsum("kmn,myn->ky", scheduled, c) + np.einsum("kmj,myj->ky", self.input, d)
        parts = []
        for signal in (scheduled, self.input):
            forcing = np.einsum("an,kmj->knamj", np.eye(n), signal).transpose(0, 1, 3, 2, 4)
            states = lu_solve(factor, forcing.reshape(period * n, -1))
            parts.append((self.coupled(c) @ states).reshape(period, n_y, -1))
        for signal in (scheduled, self.input):
            parts.append(np.einsum("yw,kmj->kymwj", np.eye(n_y), signal).reshape(period, n_y, -1))
        return output, np.concatenate(parts, axis=2)


def agreement(blocks: HarmonicBlocks, dense: Dense, theta: FloatArray) -> float:
    """The largest relative difference between the two Jacobians on common lines."""
    own, other = blocks.output_and_jacobian(theta)[1], dense(theta)[1][blocks.lines]
    return float(abs(own - other).max() / abs(other).max())


def wind_turbine(repeats: int, dense_repeats: int) -> dict[str, float]:
    """Iterations of the paper's example, in blocks and dense."""
    record = disturbed(noise_free("multisine"), 0.06, False, np.random.default_rng(1))
    steady = steady_periods(record, 1)
    preparation = timed(lambda: PeriodicResiduals.of(steady, with_constant(steady.scheduling), PLANT.order))
    residuals = PeriodicResiduals.of(steady, with_constant(steady.scheduling), PLANT.order)
    chart = SIZES.chart(THETA)
    result = {
        "preparation (periods, noise) in ms": 1e3 * preparation,
        "iteration in blocks in ms": 1e3 * median_seconds(lambda: iteration(residuals, THETA, chart), repeats),
    }
    whitening = residuals._whitening
    for name, as_written in (("as written", True), ("careful", False)):
        dense = Dense(residuals.blocks, as_written)
        result[f"Jacobian, blocks against dense {name}"] = agreement(residuals.blocks, dense, THETA)

        def dense_iteration(dense: Dense = dense) -> FloatArray:
            output, jacobian = (part[residuals.blocks.lines] for part in dense(THETA))
            columns = np.concatenate([(output - residuals.measured)[:, :, None], jacobian], axis=2)
            white = whitening(columns)
            return step(white[:, 0], white[:, 1:] @ chart)

        seconds = median_seconds(dense_iteration, dense_repeats)
        result[f"iteration dense {name} in ms"] = 1e3 * seconds
        result[f"times faster than dense {name}"] = 1e3 * seconds / result["iteration in blocks in ms"]
    return result


def random_residuals(sizes: StackSizes, period: int, scheduling_period: int) -> tuple[PeriodicResiduals, FloatArray]:
    """A random stable model with its residuals, noise of variance one."""
    generator = np.random.default_rng(1)
    theta = np.concatenate([generator.standard_normal(int(np.prod(shape))) for shape in sizes.shapes])
    end = int(np.prod(sizes.shapes[0]))
    theta[:end] *= 0.5 / (1 + (sizes.functions - 1)) / np.sqrt(sizes.order)
    u = generator.standard_normal((period, sizes.n_inputs))
    p = np.tile(generator.uniform(-1, 1, (scheduling_period, (sizes.functions - 1))), (period // scheduling_period, 1))
    blocks = HarmonicBlocks(sizes, u, with_constant(p), scheduling_period)
    measured = np.zeros((len(blocks.lines), sizes.n_outputs), dtype=complex)
    noise = HarmonicNoise(np.tile(np.eye(sizes.n_outputs, dtype=complex), (period, 1, 1)), 98)
    return PeriodicResiduals(blocks, measured, noise, np.ones(len(blocks.lines), dtype=bool)), theta


def growth(repeats: int) -> list[dict[str, float]]:
    """Milliseconds an iteration as one size after the other grows."""
    base = {"P": 500, "T": 10, "n_x": 2, "n_p": 1}
    grown = {
        "P": (250, 1000, 2000, 4000, 20_000),
        "T": (5, 20, 50, 100, 250, 500),
        "n_x": (1, 4, 6, 8, 12),
        "n_p": (2, 3, 4, 6, 10),
    }
    rows = [base, *(base | {name: value} for name, values in grown.items() for value in values)]
    rows.append({"P": 20_000, "T": 20_000, "n_x": 4, "n_p": 2})
    table = []
    for row in rows:
        sizes = StackSizes(row["n_x"], 1 + row["n_p"], 1, 1)
        residuals, theta = random_residuals(sizes, row["P"], row["T"])
        chart = sizes.chart(theta)
        seconds = median_seconds(partial(iteration, residuals, theta, chart), repeats)
        cells = {**row, "parameters": sizes.free, "ms": 1e3 * seconds}
        if residuals.blocks.largest_block < row["T"] * row["n_x"] <= 1000:
            blocks = replace(residuals, blocks=replace(residuals.blocks, largest_block=1000))
            cells["ms in blocks"] = 1e3 * median_seconds(partial(iteration, blocks, theta, chart), 1)
        table.append(cells)
    return table


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__)
    parser.add_argument("--repeats", type=int, default=50)
    parser.add_argument("--dense-repeats", type=int, default=3)
    options = parser.parse_args()
    speed = wind_turbine(options.repeats, options.dense_repeats)
    for name, value in speed.items():
        print(f"{name}: {value:.4g}")
    table = growth(max(options.repeats // 5, 3))
    print_table(table)
    write_json({"speed": speed, "growth": table}, options.output)


if __name__ == "__main__":
    main()
