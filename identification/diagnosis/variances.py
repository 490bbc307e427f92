"""Effects that change the variance: whether they are there, how large they are, and what they leave."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc, fdtrc

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.comparison.lack_of_fit import lack_of_fit
from identification.diagnosis.evidence import STRICT
from identification.effects.library import variance_library
from identification.extension.fit import Fit
from identification.extension.rows import Rows
from identification.lti.whiteness import orthonormal
from identification.places.place import Flow
from identification.places.variance import VarianceEffect

DRAWS = 4000
SIZES = np.geomspace(1e-6, 1e3, 181)
LARGEST = 5e7
BANDS = 6


@dataclass(frozen=True, eq=False)
class Variation:
    """An effect on the variance with its size τ̂ (restricted likelihood) and the p-value of its score test.

    `gain`: by how much −2 ln L falls, zero where the records tell of it without a model; `variants`: how
    many were tried.
    """

    effect: VarianceEffect
    size: float
    p_value: float
    gain: float
    variants: int


def variations(found: Fit, generator: np.random.Generator) -> tuple[Variation, ...]:
    """The score tests of τ² = 0 of all effects on the variance that these experiments can show, best variant of each.

        T = rᵀ K r − tr K,   K = Q (Σ_m s_m s_mᵀ) Q,   one-sided; its null Σ μ_i (χ²₁ − 1), μ the eigenvalues of K

    r whitened and off the fitted parameters (Q), and where records of one point are compared off whatever that point
    could be [Searle1992, Section 3.8]. p is multiplied by the number of variants.
    """
    tried = [_best(found, effect, generator) for effect in variance_library()]
    return tuple(one for one in tried if one is not None)


def _best(found: Fit, effect: VarianceEffect, generator: np.random.Generator) -> Variation | None:
    if effect.direct:
        seen = effect.seen(found.flows)
        return None if seen is None else Variation(effect, *seen, 0.0, 1)
    rows = _slopes(found) if effect.of_periods else found.residual
    if rows is None or (effect.within_points and not _repeated(found.rows.batches)):
        return None
    fixed = _fixed(found, effect)
    if fixed is None:
        return None
    variants = effect.variants(found.flows[0])
    results = []
    for one in variants:
        eigen, squares = _axes(found, one, rows, fixed)
        if len(eigen):
            size, gain = _likelihood(eigen, squares)
            freedom = found.rows.noise_freedom if one.power(found.flows[0]) is not None else np.inf
            results.append(Variation(one, size, _p_value(eigen, squares, freedom, generator), gain, len(variants)))
    if not results:
        return None
    best = max(results, key=lambda one: one.gain)
    return replace(best, p_value=min(1.0, best.p_value * len(variants)))


def _repeated(batches: Sequence[Batch]) -> bool:
    points = np.concatenate([batch.points for batch in batches])
    return len(np.unique(points, axis=0)) < len(points)


def _slopes(found: Fit) -> FloatArray | None:
    """How the periods change from first to last, whitened, (R,)."""
    slopes = [batch.slopes for batch in found.rows.batches]
    known = [one for one in slopes if one is not None]
    return found.rows.whiten([one[None] for one in known])[0] if len(known) == len(slopes) else None


def _fixed(found: Fit, effect: VarianceEffect) -> FloatArray | None:
    """An orthonormal basis (R, k) of what is not compared; None where that would be too large."""
    if effect.of_periods:
        return np.zeros((len(found.residual), 0))
    columns = found.tangents.T
    if effect.within_points:
        points = np.unique(np.concatenate([batch.points for batch in found.rows.batches]), axis=0)
        local = _gradients(found)
        if local.size * len(points) > LARGEST:
            return None
        places = [np.where(_at(found.rows, point), local, 0.0) for point in points]
        columns = np.concatenate([columns, *(part.T for part in places)], axis=1)
    size = np.linalg.norm(columns, axis=0)
    return orthonormal(columns[:, size > 0] / size[size > 0])


def _gradients(found: Fit) -> FloatArray:
    """∂Y/∂ζ of every record, whitened, (n_plant, R)."""
    return found.rows.whiten([np.swapaxes(flow.by_coefficients, 0, 1) for flow in found.flows])


def _at(rows: Rows, point: FloatArray) -> BoolArray:
    chosen = [np.all(batch.points == point, axis=1) for batch in rows.batches]
    pairs = zip(chosen, rows.batches, strict=True)
    return np.concatenate([np.repeat(one, 2 * len(batch.omega)) for one, batch in pairs])


def _axes(found: Fit, effect: VarianceEffect, rows: FloatArray, fixed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Eigenvalues μ of K and the squares of r along its axes."""
    left = rows - fixed @ (fixed.T @ rows)
    changes = [effect.change(flow) for flow in found.flows]
    if all(one is not None for one in changes):
        every = _record_by_record(found, [one for one in changes if one is not None])
        every = every - (every @ fixed) @ fixed.T
        _, sizes, axes = np.linalg.svd(every, full_matrices=False)
        kept = sizes > 1e-9 * max(float(sizes[0]), 1e-300) if len(sizes) else np.zeros(0, dtype=bool)
        return sizes[kept] ** 2, (axes[kept] @ left) ** 2
    weights = np.concatenate([_added(effect, flow, s) for flow, s in zip(found.flows, found.rows.scales, strict=True)])
    used = weights > 0
    return weights[used], left[used] ** 2


def _added(effect: VarianceEffect, flow: Flow, scale: float) -> FloatArray:
    """What the power of an effect is in whitened rows, half of it for each part, (M·2·K,)."""
    power, batch = effect.power(flow), flow.batch
    assert power is not None
    return np.asarray((batch.weights_of_rows**2 * power[:, None, :] / 2 / scale**2).ravel())


def _record_by_record(found: Fit, changes: Sequence[ComplexArray]) -> FloatArray:
    """One row for each record: its change, and nothing in the others, (records, R)."""
    total = sum(len(batch.points) for batch in found.rows.batches)
    spectra, first = [], 0
    for batch, change in zip(found.rows.batches, changes, strict=True):
        own = np.zeros((total, *change.shape), dtype=np.complex128)
        index = np.arange(len(batch.points))
        own[first + index, index] = change
        spectra.append(own)
        first += len(index)
    return found.rows.whiten(spectra)


def _likelihood(eigen: FloatArray, squares: FloatArray) -> tuple[float, float]:
    """τ̂ and the fall of −2 ln L(τ) = Σ ln(1 + τ² μ_i) + y_i²/(1 + τ² μ_i)."""
    scale = float(np.sqrt(eigen.max()))
    values = 1 + np.outer((SIZES / scale) ** 2, eigen)
    cost = np.sum(np.log(values) + squares / values, axis=1)
    nothing = float(squares.sum())
    best = int(np.argmin(cost))
    return (float(SIZES[best] / scale), nothing - float(cost[best])) if cost[best] < nothing else (0.0, 0.0)


def _p_value(eigen: FloatArray, squares: FloatArray, noise: float, generator: np.random.Generator) -> float:
    """Of Σ μ_i y_i², from draws of Σ μ_i χ²₁ and beyond them from the χ² with its first two moments.

    From F with `noise` degrees of freedom where it is all lines that are compared with the noise estimated there.
    """
    statistic = float(eigen @ squares)
    unit, freedom = float(np.sum(eigen**2) / np.sum(eigen)), float(np.sum(eigen) ** 2 / np.sum(eigen**2))
    tail = float(chdtrc(freedom, statistic / unit))
    if np.isfinite(noise):
        return float(fdtrc(freedom, noise, statistic / unit / freedom * noise / max(noise - 2, 1.0)))
    if len(eigen) > DRAWS:
        return tail
    draws = generator.chisquare(1, (DRAWS, len(eigen))) @ eigen
    above = int(np.sum(draws >= statistic))
    return (above + 1) / (DRAWS + 1) if above >= 10 else min(tail, (above + 1) / (DRAWS + 1))


def varied(found: Fit, one: Variation) -> tuple[Batch, ...]:
    """The batches of a fit with the variance of an effect of its size added to that of the noise."""
    result = []
    for flow in found.flows:
        change, power = one.effect.change(flow), one.effect.power(flow)
        batch = flow.batch
        if change is not None:
            result.append(replace(batch, varied=one.size * change[:, None]))
        elif power is not None:
            result.append(replace(batch, variances=batch.variances + one.size**2 * power))
        else:
            result.append(batch)
    return tuple(result)


def describe(one: Variation) -> str:
    """What varies by how much, in words."""
    return f"{one.effect.title}: {one.size:.3g} ({one.effect.unit}, standard deviation; p = {one.p_value:.2g})"


def evenly_explained(found: Fit) -> bool:
    """Whether noise explains what a fit leaves in every class of lines and in every part of the band.

    A variance of its own size explains any sum of squares; that of a misfit lies where the misfit is.
    """
    squares, classes, omega = [], [], []
    for batch, part in zip(found.rows.batches, found.rows.parts(found.residual**2), strict=True):
        used = batch.compared
        squares.append(part[used])
        classes.append(np.repeat(batch.classes[:, None], 2, axis=1).ravel()[used])
        omega.append(np.broadcast_to(batch.omega, (len(batch.points), 2, len(batch.omega))).ravel()[used])
    square, number, frequency = (np.concatenate(one) for one in (squares, classes, omega))
    edges = np.quantile(frequency, np.linspace(0, 1, BANDS + 1))[1:-1]
    cells = number * BANDS + np.digitize(np.asarray(frequency, dtype=np.float64), np.asarray(edges, dtype=np.float64))
    left = 1 - len(found.tangents) / found.rows.count
    tests = []
    for cell in np.unique(cells):
        chosen = square[cells == cell]
        freedom = left * len(chosen)
        tests.append(lack_of_fit("", float(chosen.sum()), freedom, found.rows.noise_freedom).p_value)
    return min(tests) * len(tests) >= STRICT
