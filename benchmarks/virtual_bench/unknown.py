"""An effect that is taken out of the library: is it called unknown, and does the picture show its shape?

Every effect that the bench can hide is taken out once, so that the table also says which effects have a near relation
in the library, by which they are then explained: a delay looks like a lag, a cubic stiffness like a shallow sine. The
law, a curve of any shape, is left out as well: here names alone are judged.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.virtual_bench.figures import quantiles, rate
from benchmarks.virtual_bench.hits import kinds
from benchmarks.virtual_bench.study import MODEL, design, effects, measured, steady
from identification.arrays import FloatArray
from identification.comparison.batch import EXCITED, Batch
from identification.comparison.compare import bands
from identification.diagnosis.diagnose import rows_of
from identification.diagnosis.missing import missing_response
from identification.diagnosis.staircase import conclusion, staircase
from identification.extension.fit import Fit, fit

SHARE = 0.03
UNLIKE_OTHERS = ("resonance", "quadratic_sensor", "cubic_dependence", "backlash")
MOSTLY = 90.0


def tasks(runs: int) -> list[tuple[str, int]]:
    """Removed effect and seed of every run."""
    return [(kind, r) for kind in kinds() for r in range(runs)]


def one(task: tuple[str, int]) -> dict[str, Any]:
    """One run."""
    kind, seed = task
    library = [one for one in effects(design()) if one.kind not in (kind, "law")]
    batches = measured((kind,), SHARE, np.random.default_rng(seed))
    steps = staircase(MODEL, batches, effects=library, largest=2, seed=seed)
    first = steps[0].diagnosis
    return {
        "kind": kind,
        "seed": seed,
        "conclusion": conclusion(steps),
        "verdict": first.verdict,
        "confident": any(step.diagnosis.confident for step in steps),
        "added": [one.effect.kind for one in steps[-1].model.effects],
        **correlations(kind, first.base),
    }


def pictures(kind: str, seed: int = 0) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Operating points (M,), frequencies (F,), and |δG| (M, F) that is missing, as it is found and as it is."""
    batches = measured((kind,), SHARE, np.random.default_rng(seed))
    base = fit(MODEL, rows_of(MODEL, batches))
    seen, true = (missing_response(found) for found in (base, without_noise(kind, base)))
    points = np.concatenate([one.points[:, 0] for one in seen])
    found, wanted = (abs(np.concatenate([one.response for one in each])) for each in (seen, true))
    return points, seen[0].frequencies, found, wanted


def correlations(kind: str, base: Fit) -> dict[str, float]:
    """Of the smooth response that is missing, and of the map of excess over noise by record, band and line class."""
    exact = without_noise(kind, base)
    responses = [np.concatenate([one.response for one in missing_response(found)]) for found in (base, exact)]
    maps = [misfit_map(found, noise) for found, noise in ((base, 1.0), (exact, 0.0))]
    return {
        "correlation of the response": _cosine(*responses),
        "correlation of the map": _cosine(*maps),
        "share of the response in what is missing": _linear_share(exact),
    }


def without_noise(kind: str, base: Fit) -> Fit:
    """The fit with the residual that the data would leave without noise, whitened alike."""
    y = steady((kind,))[1]
    clean = np.fft.rfft(y) / y.shape[1]
    exact = tuple(replace(batch, outputs=clean[batch.members]) for batch in base.rows.batches)
    rows = replace(base.rows, batches=exact)
    return replace(base, rows=rows, residual=rows.residual(base.flows))


def misfit_map(found: Fit, noise: float) -> FloatArray:
    """Mean |r|² less that of noise, (M, bands, line classes)."""
    pairs = zip(found.rows.batches, found.rows.parts(found.residual), strict=True)
    return np.concatenate([_means(batch, abs(batch.complex_residual(part)) ** 2 - noise) for batch, part in pairs])


def _means(batch: Batch, z: FloatArray) -> FloatArray:
    edges = [(batch.omega > low) & (batch.omega <= high) for low, high in bands([batch])]
    chosen = [[band[None] & (batch.classes == n) for n in range(3)] for band in edges]
    means = [[np.sum(z * c, axis=1) / np.maximum(c.sum(axis=1), 1) for c in row] for row in chosen]
    return np.moveaxis(np.array(means), -1, 0)


def _linear_share(found: Fit) -> float:
    """Share of the excited lines in the energy that is missing."""
    excited = total = 0.0
    for batch, part in zip(found.rows.batches, found.rows.parts(found.residual), strict=True):
        energy = abs(batch.complex_residual(part)) ** 2
        excited, total = excited + float(np.sum(energy[batch.classes == EXCITED])), total + float(np.sum(energy))
    return excited / total


def _cosine(one: np.ndarray, other: np.ndarray) -> float:
    return float(abs(np.vdot(one, other)) / np.linalg.norm(one) / np.linalg.norm(other))


def summary(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Rates and correlations for each removed effect, and over those that have no near relation in the library."""
    removed = list(dict.fromkeys(run["kind"] for run in runs))
    each = {kind: _of([run for run in runs if run["kind"] == kind]) for kind in removed}
    unlike = [run for run in runs if run["kind"] in UNLIKE_OTHERS]
    known = [kind for kind, found in each.items() if found["not in the library"]["percent"] < MOSTLY]
    return {"unlike others": _of(unlike), "explained by a relation": known, "each": each}


def _of(runs: list[dict[str, Any]]) -> dict[str, Any]:
    measures = [name for name in runs[0] if name.startswith(("correlation", "share"))]
    return {
        "not in the library": rate([run["conclusion"] == "not in the library" for run in runs]),
        "a wrong effect with confidence": rate([run["confident"] for run in runs]),
        **{name: quantiles([run[name] for run in runs]) for name in measures},
        "added": sorted({", ".join(run["added"]) for run in runs}),
    }
