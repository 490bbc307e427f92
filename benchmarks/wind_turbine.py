"""The wind turbine of the paper, many runs: how well do both methods fit, and is the Cramér–Rao bound reached?

    python -m benchmarks.wind_turbine [--runs 1000] [--workers 2] [--seed 1] [--noise 0.06] [--window 5]
                                      [--methods white coloured moesp] [--output FILE.json] [--page FILE.html]

The plant and the experiments of [Goos2014, Section 5]: 50 000 samples, p(t) = cos(2πt/10), periods of 500 samples of
which the first is dropped, or white noise as input for periodic MOESP; the same input in every run, power one, and
noise of its own, white or coloured, standard deviation `--noise`. Asked for are

- variance accounted for on noise-free validation data: mean ≥ 99.998 %, standard deviation ≤ 0.0016 %, and periodic
  MOESP spreading more at the same noise;
- eigenvalues of A_i inside the 95 % Cramér–Rao ellipse (interval, where they are real) at the truth in so many runs as
  the 99 % interval of the binomial distribution allows, and the truth as often inside the ellipse each run states;
- the covariance over the runs within 10 % of the Cramér–Rao bound, averaged over the 14 directions that the response
  depends on.
"""

from dataclasses import dataclass
from functools import partial
from time import perf_counter

import numpy as np
from scipy.stats import binom, chi2

from benchmarks.command import command_line, print_table, write_json
from benchmarks.processes import spread
from benchmarks.wind_turbine_pictures import Cloud, pictures
from benchmarks.wind_turbine_plant import (
    PLANT,
    THETA,
    aligned,
    cramer_rao,
    disturbed,
    noise_free,
    validation_fits,
)
from identification.arrays import ComplexArray, FloatArray
from identification.models.model import Model
from identification.varying.eigenvalues import eigenvalue_covariance, eigenvalues
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.periodic_moesp import PeriodicMoesp

BATCH = 25
NAMES = {
    "white": "maximum likelihood, white noise",
    "coloured": "maximum likelihood, coloured noise",
    "moesp": "periodic MOESP, white noise",
}


@dataclass(frozen=True, eq=False)
class Runs:
    """Of n runs: θ̂ in the basis nearest to the truth (n, size), eigenvalues (n, 3), their stated covariances, VAF."""

    theta: FloatArray
    eigenvalues: ComplexArray
    stated: FloatArray
    fits: FloatArray
    converged: int


def three_eigenvalues(model: Model) -> tuple[ComplexArray, FloatArray]:
    """The upper one of A_0 and both of A_1 by their real parts, (3,), with their covariances (3, 2, 2)."""
    values = eigenvalues(model)
    order = np.argsort(values[1].real)
    upper = int(np.argmax(values[0].imag))
    kept = np.concatenate([values[0, [upper]], values[1, order]])
    if model.covariance is None:
        return kept, np.full((3, 2, 2), np.nan)
    covariance = eigenvalue_covariance(model)
    return kept, np.concatenate([covariance[0, [upper]], covariance[1, order]])


def batch(method: str, noise: float, window: int, count: int, seed: np.random.SeedSequence) -> Runs:
    """`count` runs, their models validated all at once."""
    generator = np.random.default_rng(seed)
    clean = noise_free("white" if method == "moesp" else "multisine")
    estimates = []
    for _ in range(count):
        record = disturbed(clean, noise, method == "coloured", generator)
        if method == "moesp":
            estimates.append(PeriodicMoesp(window=window, varying_output=False).estimate(record, PLANT.order))
        else:
            estimates.append(PeriodicLikelihood(drop_periods=1).estimate(record, PLANT.order))
    eigenvalues, stated = zip(*(three_eigenvalues(estimate.model) for estimate in estimates), strict=True)
    models = [estimate.model for estimate in estimates]
    return Runs(
        np.array([aligned(model) for model in models]),
        np.array(eigenvalues),
        np.array(stated),
        validation_fits(models),
        sum(estimate.outcome.ok for estimate in estimates),
    )


def all_runs(method: str, runs: int, seed: int, workers: int, noise: float, window: int) -> Runs:
    """All runs of a method, spread over processes in batches of 25 (a last one may be larger than asked for)."""
    size = min(BATCH, runs)
    parts = spread(partial(batch, method, noise, window, size), -(-runs // size), seed, workers)
    joined = (np.concatenate([getattr(part, name) for part in parts])[:runs] for name in FIELDS)
    return Runs(*joined, sum(part.converged for part in parts))


FIELDS = ("theta", "eigenvalues", "stated", "fits")


def bound(method: str, noise: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """P_θ and its chart at the truth, and the covariances of the three eigenvalues."""
    covariance, chart = cramer_rao(noise, method == "coloured")
    _, ellipses = three_eigenvalues(PLANT.model(covariance))
    return covariance, chart, ellipses


def inside(deviations: ComplexArray, covariances: FloatArray) -> FloatArray:
    """Share of runs inside the 95 % ellipse, or interval where the covariance (…, 3, 2, 2) has no imaginary part."""
    shares = []
    for i in range(deviations.shape[1]):
        parts = np.stack([deviations[:, i].real, deviations[:, i].imag], axis=-1)
        own = np.broadcast_to(covariances[..., i, :, :], (len(parts), 2, 2))
        real = i > 0
        used = slice(0, 1 if real else 2)
        distance = np.einsum("ri,rij,rj->r", parts[:, used], np.linalg.inv(own[:, used, used]), parts[:, used])
        shares.append(float(np.mean(distance <= chi2.ppf(0.95, 1 if real else 2))))
    return np.array(shares)


def summary(method: str, runs: Runs, noise: float, seconds: float) -> dict[str, object]:
    """The figures asked for."""
    covariance, chart, ellipses = bound("white" if method == "moesp" else method, noise)
    lowest = np.sqrt([*np.diag(ellipses[0]), *ellipses[1:, 0, 0]])
    result: dict[str, object] = {
        "case": NAMES[method],
        "runs": len(runs.fits),
        "converged": runs.converged,
        "standard deviation of the noise": noise,
        "output over noise in dB": 20 * np.log10(float(noise_free("multisine").output.std()) / noise),
        "VAF in %, mean": float(runs.fits.mean()),
        "VAF in %, standard deviation": float(runs.fits.std(ddof=1)),
        "VAF in %, smallest": float(runs.fits.min()),
        "eigenvalues over their Cramér–Rao deviations": (deviations(runs.eigenvalues) / lowest).round(4).tolist(),
    }
    if method != "moesp":
        result |= efficiency((runs.theta - THETA) @ chart, chart.T @ covariance @ chart) | coverage(runs, ellipses)
    return result | {"seconds": seconds}


def efficiency(errors: FloatArray, covariance: FloatArray) -> dict[str, object]:
    """The eigenvalues of the covariance over the runs, (n, free) errors in a chart, against the bound there."""
    count, free = errors.shape
    root = np.linalg.cholesky(np.linalg.inv(covariance))
    ratios = np.linalg.eigvalsh(root.T @ np.cov(errors.T) @ root)
    return {
        f"covariance over Cramér–Rao bound, mean of {free} directions": float(ratios.mean()),
        "its extremes": [float(ratios[0]), float(ratios[-1])],
        "where their sampling ends": [(1 + sign * (free / count) ** 0.5) ** 2 for sign in (-1, 1)],
    }


def coverage(runs: Runs, ellipses: FloatArray) -> dict[str, object]:
    """Shares of runs inside the bound's 95 % ellipses and inside those the runs state, and whether all may be 95 %."""
    truth, _ = three_eigenvalues(PLANT.model())
    interval = binom.ppf([0.005, 0.995], len(runs.fits), 0.95) / len(runs.fits)
    shares = [inside(runs.eigenvalues - truth, covariances) for covariances in (ellipses, runs.stated)]
    return {
        "inside the 95 % Cramér–Rao ellipses": shares[0].tolist(),
        "truth inside the 95 % ellipses that are stated": shares[1].tolist(),
        "99 % interval of 95 %": interval.tolist(),
        "all shares within it": bool(np.all((interval[0] <= shares) & (shares <= interval[1]))),
    }


def deviations(eigenvalues: ComplexArray) -> FloatArray:
    """Of Re and Im of the complex eigenvalue of A_0, and of both real ones of A_1."""
    columns = (eigenvalues[:, 0].real, eigenvalues[:, 0].imag, eigenvalues[:, 1].real, eigenvalues[:, 2].real)
    return np.array([np.std(column, ddof=1) for column in columns])


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = command_line(__doc__, runs=1000, seed=1, page=True)
    parser.add_argument("--noise", type=float, default=0.06, help="standard deviation (default %(default)s)")
    parser.add_argument("--window", type=int, default=5, help="of periodic MOESP (default %(default)s)")
    parser.add_argument("--methods", nargs="+", choices=list(NAMES), default=list(NAMES))
    options = parser.parse_args()
    results, figures = {}, []
    for method in options.methods:
        start = perf_counter()
        results[method] = all_runs(method, options.runs, options.seed, options.workers, options.noise, options.window)
        figures.append(summary(method, results[method], options.noise, perf_counter() - start))
    names = dict.fromkeys(name for each in figures for name in each if name != "case")
    print_table([{"": name} | {str(each["case"]): each.get(name) for each in figures} for name in names])
    write_json(figures, options.output)
    if options.page:
        truth, _ = three_eigenvalues(PLANT.model())
        clouds = {
            NAMES[method]: Cloud(
                runs.fits, runs.eigenvalues, bound("white" if method == "moesp" else method, options.noise)[2]
            )
            for method, runs in results.items()
        }
        pictures(clouds, truth, options.noise).write_html(options.page, include_plotlyjs=True)


if __name__ == "__main__":
    main()
