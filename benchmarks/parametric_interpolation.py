"""One per cent of noise: parametric models against interpolation, between the operating points that were measured.

python -m benchmarks.parametric_interpolation [--runs 20] [--noise 0.01] [--output FILE.json]
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.command import command_line, write_json
from benchmarks.kergus_example import AFFINE, LINES, SAMPLE_TIME, truth
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.parametric.state_space_likelihood import StateSpaceLikelihood
from identification.pole_regions.disc import Disc
from identification.signals import FrequencyResponse

MEASURED = np.linspace(0, 1, 6)
BETWEEN = np.linspace(0.05, 0.95, 10)
Z = np.exp(1j * LINES * SAMPLE_TIME)


@dataclass(frozen=True, eq=False)
class Barycentric:
    """r(z, p) = Σ α_ij h_ij/((z − z_i)(p − p_j)) / Σ α_ij/((z − z_i)(p − p_j)), which interpolates h_ij."""

    z: Any
    p: Any
    values: Any
    weights: Any

    def __call__(self, z: Any, p: Any) -> Any:
        """r at all z (F,) and p (M,), as (F, M); nodes are moved by a rounding error."""
        first, second = _cauchy(z, self.z), _cauchy(p, self.p)
        return (first @ (self.weights * self.values) @ second.T) / (first @ self.weights @ second.T)


def _cauchy(x: Any, nodes: Any) -> Any:
    difference = x[:, None] - nodes[None, :]
    return 1 / np.where(difference == 0, 1e-13, difference)


def parametric_aaa(samples: Any, largest: tuple[int, int], tolerance: float) -> Barycentric:
    """Greedy interpolation in z and p (the parametric AAA algorithm): samples (F, M), at most `largest` nodes."""
    rows, columns = [], []
    approximation = np.full(samples.shape, samples.mean())
    model = None
    while True:
        error = abs(samples - approximation)
        if error.max() <= tolerance * abs(samples).max():
            break
        error[rows] = -1 if len(columns) == largest[1] else error[rows]
        i, j = np.unravel_index(error.argmax(), error.shape)
        grown = False
        if i not in rows and len(rows) < largest[0]:
            rows, grown = [*rows, int(i)], True
        if j not in columns and len(columns) < largest[1]:
            columns, grown = [*columns, int(j)], True
        if not grown:
            break
        model = _weighted(samples, rows, columns)
        approximation = model(Z, MEASURED)
    assert model is not None
    return model


def _weighted(samples: Any, rows: list[int], columns: list[int]) -> Barycentric:
    """The weights that minimise the linearised error at all samples that are not interpolated."""
    nodes, places = Z[rows], MEASURED[columns]
    values = samples[np.ix_(rows, columns)]
    blocks = []
    for m, p in enumerate(MEASURED):
        second = np.eye(len(columns))[columns.index(m)] if m in columns else 1 / (p - places)
        for k, z in enumerate(Z):
            first = np.eye(len(rows))[rows.index(k)] if k in rows else 1 / (z - nodes)
            if not (m in columns and k in rows):
                blocks.append(((samples[k, m] - values) * first[:, None] * second).ravel())
    weights = np.linalg.svd(np.array(blocks), full_matrices=False)[2][-1].conj()
    return Barycentric(nodes, places, values, weights.reshape(values.shape))


def errors(found: Any, plant: Any) -> float:
    """The largest relative error (Frobenius over the lines) over the operating points, of (M, F) responses."""
    return float((np.linalg.norm(found - plant, axis=1) / np.linalg.norm(plant, axis=1)).max())


def compare(seed: int, noise: float) -> dict[str, float]:
    """Errors of all methods between the measured operating points, on one data set."""
    g = np.random.default_rng(seed)
    clean = np.array([truth(p) for p in MEASURED])
    sigma = noise * np.linalg.norm(clean, axis=1, keepdims=True) / np.sqrt(len(LINES))
    noisy = clean + sigma * (g.standard_normal((*clean.shape, 2)) @ [1, 1j]) / np.sqrt(2)
    data = [
        FrequencyResponse(LINES, r, (float(p),), SAMPLE_TIME, np.full(len(LINES), s[0] ** 2))
        for r, p, s in zip(noisy, MEASURED, sigma, strict=True)
    ]
    subspace = ParametricSubspace(2, 10, region=Disc()).estimate(AFFINE, data).model
    refined = StateSpaceLikelihood(region=Disc()).estimate(subspace, data).model
    plant = np.array([truth(p) for p in BETWEEN])
    result = {
        name: errors(model.frequency_response(BETWEEN[:, None], LINES)[..., 0, 0], plant)
        for name, model in (("parametric subspace", subspace), ("maximum likelihood", refined))
    }
    samples = noisy.T
    result["parametric AAA, true degrees"] = errors(parametric_aaa(samples, (3, 2), 0.0)(Z, BETWEEN).T, plant)
    result["parametric AAA, up to degrees 10 and 5"] = errors(
        parametric_aaa(samples, (11, 6), noise)(Z, BETWEEN).T, plant
    )
    return result


def main() -> None:
    """Print a row per method, and write the figures."""
    parser = command_line(__doc__, runs=20)
    parser.add_argument("--noise", type=float, default=0.01)
    arguments = parser.parse_args()
    runs = [compare(seed, arguments.noise) for seed in range(arguments.runs)]
    table = {
        name: {"median": float(np.median([r[name] for r in runs])), "largest": max(r[name] for r in runs)}
        for name in runs[0]
    }
    print(f"largest relative error between the operating points, noise {arguments.noise:g} of the response")
    for name, row in table.items():
        print(f"{name:40s} median {row['median']:.4f}   largest {row['largest']:.4f}")
    write_json({"noise": arguments.noise, "errors": table}, arguments.output)


if __name__ == "__main__":
    main()
