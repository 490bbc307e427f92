"""The wind turbine of the paper, many runs: how well do both methods fit, and is the Cramér–Rao bound reached?

    python -m benchmarks.wind_turbine [--runs 1000] [--workers 2] [--seed 1] [--noise 0.06] [--window 5]
                                      [--methods white coloured moesp] [--output FILE.json] [--pictures FILE.html]

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

import argparse
import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots
from scipy.stats import binom, chi2

from benchmarks.processes import spread
from benchmarks.wind_turbine_plant import (
    PLANT,
    SIZES,
    THETA,
    aligned,
    cramer_rao,
    disturbed,
    noise_free,
    validation_fits,
)
from identification.affine_estimate import AffineEstimate
from identification.arrays import ComplexArray, FloatArray
from identification.outcome import Outcome
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


def three_eigenvalues(estimate: AffineEstimate) -> tuple[ComplexArray, FloatArray]:
    """The upper one of A_0 and both of A_1 by their real parts, (3,), with their covariances (3, 2, 2)."""
    values = estimate.model.eigenvalues()
    order = np.argsort(values[1].real)
    upper = int(np.argmax(values[0].imag))
    kept = np.concatenate([values[0, [upper]], values[1, order]])
    if estimate.covariance is None:
        return kept, np.full((3, 2, 2), np.nan)
    covariance = estimate.eigenvalue_covariance()
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
    eigenvalues, stated = zip(*(three_eigenvalues(estimate) for estimate in estimates), strict=True)
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
    _, ellipses = three_eigenvalues(AffineEstimate(PLANT, Outcome("converged"), (), covariance))
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
    count = len(runs.fits)
    truth, _ = three_eigenvalues(AffineEstimate(PLANT, Outcome("converged"), ()))
    result: dict[str, object] = {
        "case": NAMES[method],
        "runs": count,
        "noise": noise,
        "converged": runs.converged,
        "VAF, mean": float(runs.fits.mean()),
        "VAF, standard deviation": float(runs.fits.std(ddof=1)),
        "VAF, smallest": float(runs.fits.min()),
        "eigenvalues, standard deviations": deviations(runs.eigenvalues),
    }
    covariance, chart, ellipses = bound("white" if method == "moesp" else method, noise)
    result["eigenvalues, Cramér–Rao deviations"] = np.sqrt([*np.diag(ellipses[0]), *ellipses[1:, 0, 0]]).tolist()
    if method != "moesp":
        error = (runs.theta - THETA) @ chart
        information = np.linalg.inv(chart.T @ covariance @ chart)
        ratios = np.linalg.eigvalsh(
            np.linalg.cholesky(information).T @ np.cov(error.T) @ np.linalg.cholesky(information)
        )
        result["covariance over Cramér–Rao bound, mean of 14 directions"] = float(ratios.mean())
        result["its extremes"] = [float(ratios[0]), float(ratios[-1])]
        result["their sampling edges"] = [
            (1 - (SIZES.free / count) ** 0.5) ** 2,
            (1 + (SIZES.free / count) ** 0.5) ** 2,
        ]
        result["inside the Cramér–Rao ellipses"] = inside(runs.eigenvalues - truth, ellipses).tolist()
        result["truth inside the stated ellipses"] = inside(runs.eigenvalues - truth, runs.stated).tolist()
        result["99 % interval of 95 %"] = (binom.ppf([0.005, 0.995], count, 0.95) / count).tolist()
    return result | {"seconds": seconds}


def deviations(eigenvalues: ComplexArray) -> list[float]:
    """Of Re and Im of the complex eigenvalue of A_0, and of both real ones of A_1."""
    columns = (eigenvalues[:, 0].real, eigenvalues[:, 0].imag, eigenvalues[:, 1].real, eigenvalues[:, 2].real)
    return [float(np.std(column, ddof=1)) for column in columns]


def ellipse(centre: complex, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The 95 % ellipse as a curve."""
    angle = np.linspace(0, 2 * np.pi, 200)
    curve = np.sqrt(chi2.ppf(0.95, 2)) * np.linalg.cholesky(covariance) @ np.stack([np.cos(angle), np.sin(angle)])
    return curve[0] + centre.real, curve[1] + centre.imag


def pictures(results: dict[str, Runs], noise: float) -> go.Figure:
    """Histograms of VAF, the cloud of the complex eigenvalue with its ellipse, and the real ones with intervals."""
    truth, _ = three_eigenvalues(AffineEstimate(PLANT, Outcome("converged"), ()))
    titles = [f"{NAMES[m]}: {what}" for m in results for what in ("VAF in %", "eigenvalue of A₀", "eigenvalues of A₁")]
    figure = make_subplots(rows=len(results), cols=3, subplot_titles=titles)
    for row, (method, runs) in enumerate(results.items(), 1):
        _, _, ellipses = bound("white" if method == "moesp" else method, noise)
        cloud, real = runs.eigenvalues[:, 0], runs.eigenvalues[:, 1:].real
        x, y = ellipse(complex(truth[0]), ellipses[0])
        half = np.sqrt(chi2.ppf(0.95, 1) * ellipses[1:, 0, 0])
        marks = {"size": 3, "opacity": 0.5}
        figure.add_trace(go.Histogram(x=runs.fits, nbinsx=60), row, 1)
        figure.add_trace(go.Scatter(x=cloud.real, y=cloud.imag, mode="markers", marker=marks), row, 2)
        figure.add_trace(go.Scatter(x=x, y=y, mode="lines", line={"color": "black"}), row, 2)
        figure.add_trace(go.Scatter(x=real[:, 0], y=real[:, 1], mode="markers", marker=marks), row, 3)
        for i, axis in ((0, "v"), (1, "h")):
            for sign in (-1, 1):
                at = float(truth[1 + i].real + sign * half[i])
                getattr(figure, f"add_{axis}line")(at, row=row, col=3, line={"dash": "dot"})
    figure.update_layout(showlegend=False, height=420 * len(results), width=1400, title=f"noise {noise}, 95 % bounds")
    return figure


def main() -> None:
    """Parses the command line, runs, prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--noise", type=float, default=0.06)
    parser.add_argument("--window", type=int, default=5)
    parser.add_argument("--methods", nargs="+", choices=list(NAMES), default=list(NAMES))
    parser.add_argument("--output", type=Path)
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    results, figures = {}, []
    for method in options.methods:
        start = perf_counter()
        results[method] = all_runs(method, options.runs, options.seed, options.workers, options.noise, options.window)
        figures.append(summary(method, results[method], options.noise, perf_counter() - start))
        for name, value in figures[-1].items():
            print(f"{name}: {value:.6g}" if isinstance(value, float) else f"{name}: {value}", flush=True)
        print()
    if options.output:
        options.output.write_text(json.dumps(figures, indent=2, ensure_ascii=False) + "\n")
    if options.pictures:
        pictures(results, options.noise).write_html(options.pictures, include_plotlyjs=True)


if __name__ == "__main__":
    main()
