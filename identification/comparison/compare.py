"""A model held against measurements: maps of normalised residuals, tests by place, fit in per cent."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.special import fdtrc

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import CLASS_NAMES, EXCITED, Batch
from identification.comparison.between import strongest_line
from identification.comparison.disturbance import Disturbance
from identification.comparison.lack_of_fit import lack_of_fit
from identification.comparison.noise import noise_freedom
from identification.comparison.responses import ComparedResponses, compared_responses
from identification.errors import MisuseError
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows, effect_tangents, plant_tangents
from identification.extension.settle import off_poles, settled
from identification.lti.whiteness import orthonormal
from identification.models.model import Model, require_matching
from identification.outcome import TestResult
from identification.places.place import Flow
from identification.places.ports import Port

BANDS = 6


@dataclass(frozen=True, eq=False)
class MisfitMap:
    """Normalised residuals z (M, K) of one grid, E|z|² = 1 when nothing is missing; NaN-free: `compared` says where.

    `points` (M, s), `frequencies` (K,) rad/s, `classes` (M, K) and `ports` as in `identification.comparison.batch`.
    """

    points: FloatArray
    frequencies: FloatArray
    residual: ComplexArray
    compared: BoolArray
    classes: IntArray
    members: IntArray
    responses: ComparedResponses
    ports: IntArray | None = None


@dataclass(frozen=True, eq=False)
class Comparison:
    """What a comparison found: maps; tests overall, by operating point, by band and by line class; fit of each record.

    `tests` are empty where the size of the noise is not known. `refitted` and `refit_percent` (experiments,): what a
    refit to these data would bring, None for held-out ones. `dependence` and `dynamics` split the lack of fit of such a
    refit: the first asks whether one LTI model per operating point would fit better than the dependence on p, the
    second whether even those do not fit. `notes`: what is to be said of measurements, by their place in the list.
    `fit_percent` (experiments,) 100 (1 − ‖y − ŷ‖/‖y − ȳ‖) at the excited lines. `by_path`: from each input to each
    output, where there are several.
    """

    maps: tuple[MisfitMap, ...]
    overall: TestResult | None
    by_point: tuple[TestResult, ...]
    by_band: tuple[TestResult, ...]
    by_class: tuple[TestResult, ...]
    dependence: TestResult | None
    dynamics: TestResult | None
    between: tuple[TestResult, ...]
    disturbances: tuple[tuple[int, Disturbance], ...]
    fit_percent: FloatArray
    refitted: TestResult | None = None
    refit_percent: FloatArray | None = None
    notes: tuple[tuple[int, str], ...] = ()
    by_path: tuple[TestResult, ...] = ()


@dataclass(frozen=True, eq=False)
class _Judge:
    """Sums of squares of selected rows and what they are worth, for data that were fitted or that were held out."""

    rows: Rows
    residual: FloatArray
    tangents: FloatArray
    covariance: FloatArray | None
    compared: BoolArray
    leverage: FloatArray

    def test(self, name: str, chosen: BoolArray) -> TestResult:
        """Lack of fit of the chosen rows (R,)."""
        chosen = chosen & self.compared
        residual, count = self.rows.judged(self.residual)[chosen], float(self.rows.shares[chosen].sum())
        energy, freedom = float(residual @ residual), count - float(self.leverage[chosen].sum())
        if self.covariance is not None:
            tangents = _root(self.covariance).T @ self.tangents[:, chosen]
            values, vectors = np.linalg.eigh(tangents @ tangents.T)
            energy -= float(np.sum((vectors.T @ (tangents @ residual)) ** 2 / (1 + np.maximum(values, 0.0))))
        return lack_of_fit(name, energy, freedom, self._noise_freedom(chosen))

    def _noise_freedom(self, chosen: BoolArray) -> float:
        return noise_freedom(self.rows.batches, self.rows.parts(chosen / max(float(chosen.sum()), 1.0)))


def compare(model: Model, batches: Sequence[Batch], fitted: bool = True) -> Comparison:
    """Hold a model, as it is, against batches of measurements.

    `fitted`: the model was fitted to these very data; as many degrees of freedom as its parameters are taken off, and
    what a refit would bring is told beside. Otherwise the model's own uncertainty is added to that of the noise: r has
    the covariance I + J P Jᵀ. Raises MisuseError for a model without (finite) covariance then.
    """
    require_matching(model, batches)
    model = off_poles(model, batches)
    rows = Rows(settled(model, batches, refit=False))
    batches = rows.batches
    flows, judge = _fitted(model, rows) if fitted else _held_out(model, rows)
    refit = fit(model, rows) if fitted else None
    brought = None if refit is None else _fit_percent(batches, refit.flows)
    z = judge.residual
    if judge.covariance is not None:
        z = z / np.sqrt(1 + np.einsum("kr,kl,lr->r", judge.tangents, judge.covariance, judge.tangents))
    maps = tuple(_map(*one) for one in zip(batches, rows.parts(z), flows, strict=True))
    percent = _fit_percent(batches, flows)
    between = tuple(strongest_line(powers) for batch in batches for powers in batch.between)
    disturbances = _disturbances(batches)
    notes = tuple(sorted(note for batch in batches for note in batch.notes))
    if not rows.scaled:
        return Comparison(maps, None, (), (), (), None, None, between, disturbances, percent, None, brought, notes)
    everything = np.ones(len(z), dtype=np.bool_)
    overall = judge.test("lack of fit", everything)
    refitted, dependence, dynamics = (None, None, None) if refit is None else _split(refit)
    return Comparison(
        maps,
        overall,
        tuple(judge.test(name, chosen) for name, chosen in _points(rows)),
        tuple(judge.test(name, chosen) for name, chosen in _bands(rows)),
        tuple(judge.test(name, chosen) for name, chosen in _classes(rows)),
        dependence,
        dynamics,
        between,
        disturbances,
        percent,
        refitted,
        brought,
        notes,
        tuple(judge.test(name, chosen) for name, chosen in _paths(rows)),
    )


def _disturbances(batches: Sequence[Batch]) -> tuple[tuple[int, Disturbance], ...]:
    """The disturbances found, with the places of their experiments in the user's list."""
    pairs = [pair for b in batches for pair in zip(b.members, b.disturbances, strict=False)]
    every = [(int(m), one) for m, found in pairs for one in found]
    return tuple(sorted(every, key=lambda pair: pair[0]))


def _root(covariance: FloatArray) -> FloatArray:
    """S with S Sᵀ = P, for P that may be singular: parameters that are known exactly."""
    scale = np.sqrt(np.diagonal(covariance))
    size = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
    return np.asarray(size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))


def _compared(rows: Rows) -> BoolArray:
    return np.concatenate([batch.compared for batch in rows.batches])


def _fitted(model: Model, rows: Rows) -> tuple[tuple[Flow, ...], _Judge]:
    flows = tuple(model.respond(batch) for batch in rows.batches)
    tangents = _tangents(model, rows, flows)
    return flows, _Judge(rows, rows.residual(flows), tangents, None, _compared(rows), _leverage(tangents))


def _leverage(tangents: FloatArray) -> FloatArray:
    return np.asarray(np.sum(orthonormal(tangents.T) ** 2, axis=1))


def _tangents(model: Model, rows: Rows, flows: tuple[Flow, ...]) -> FloatArray:
    every = [plant_tangents(model, rows, flows), *(effect_tangents(one, rows, flows) for one in model.effects)]
    return np.concatenate(every)


def _held_out(model: Model, rows: Rows) -> tuple[tuple[Flow, ...], _Judge]:
    flows = tuple(model.respond(batch) for batch in rows.batches)
    covariance = _covariance(model)
    start = model.plant_size
    for one in model.effects:
        stop = start + len(one.parameters())
        covariance[start + one.size : stop] /= one.effect.values()[:, None]
        covariance[:, start + one.size : stop] /= one.effect.values()
        start = stop
    residual = rows.residual(flows)
    nothing = np.zeros(len(residual))
    return flows, _Judge(rows, residual, _tangents(model, rows, flows), covariance, _compared(rows), nothing)


def _covariance(model: Model) -> FloatArray:
    found = model.known_covariance
    if found is None or not np.all(np.isfinite(found)):
        raise MisuseError("the model has no covariance; fit it to data first, or state its covariance", "model")
    return np.array(found)


def _map(batch: Batch, rows: FloatArray, flow: Flow) -> MisfitMap:
    compared, residual = np.isfinite(batch.variances), batch.complex_residual(rows)
    responses = compared_responses(batch, flow.output)
    return MisfitMap(
        batch.points, batch.omega, residual, compared, batch.classes, batch.members, responses, batch.ports
    )


def _fit_percent(batches: Sequence[Batch], flows: Sequence[Flow]) -> FloatArray:
    error, size = np.zeros((2, 1 + max(int(batch.members.max()) for batch in batches)))
    for batch, flow in zip(batches, flows, strict=True):
        used = (batch.classes == EXCITED) & np.isfinite(batch.variances)
        np.add.at(error, batch.members, np.sum(abs(batch.outputs - flow.output) ** 2 * used, axis=1))
        np.add.at(size, batch.members, np.sum(abs(batch.outputs) ** 2 * used, axis=1))
    return np.asarray(100 * (1 - np.sqrt(error / size)))


def _spread(rows: Rows, chosen: Sequence[BoolArray]) -> BoolArray:
    """Choices of lines (M, K), one a batch, as a choice of rows (R,)."""
    return np.concatenate([np.repeat(one[:, None, :], 2, axis=1).ravel() for one in chosen])


def _points(rows: Rows) -> list[tuple[str, BoolArray]]:
    every = np.unique(np.concatenate([batch.points for batch in rows.batches]), axis=0)
    found = []
    for point in every:
        chosen = [np.repeat(np.all(b.points == point, axis=1)[:, None], len(b.omega), axis=1) for b in rows.batches]
        found.append((f"p = {', '.join(f'{value:g}' for value in point)}", _spread(rows, chosen)))
    return found


def _paths(rows: Rows) -> list[tuple[str, BoolArray]]:
    """From each input to each output, where there are several; noise is made uncorrelated in their order."""
    outputs, inputs = rows.batches[0].shape
    found = []
    for port in (Port(i, k) for i in range(outputs) for k in range(inputs)) if outputs * inputs > 1 else ():
        chosen = [port.acts(b.ports, len(b.points)) for b in rows.batches]
        lines = [np.repeat(one[:, None], len(b.omega), axis=1) for one, b in zip(chosen, rows.batches, strict=True)]
        found.append((str(port), _spread(rows, lines)))
    return found


def bands(batches: Sequence[Batch]) -> list[tuple[float, float]]:
    """Ends, rad/s, of bands of equal ratio over the excited frequencies, and of what lies below (−1) and above (∞)."""
    ends = np.array([batch.band for batch in batches])
    inner = np.geomspace(ends[:, 0].min() * (1 - 1e-9), ends[:, 1].max() * (1 + 1e-9), BANDS + 1)
    edges = np.concatenate([[-1.0], inner, [np.inf]])
    return [(float(low), float(high)) for low, high in pairwise(edges) if any(_holds(b, low, high) for b in batches)]


def _holds(batch: Batch, low: float, high: float) -> bool:
    return bool(np.any(np.isfinite(batch.variances[:, (batch.omega > low) & (batch.omega <= high)])))


def _bands(rows: Rows) -> list[tuple[str, BoolArray]]:
    found = []
    for low, high in bands(rows.batches):
        chosen = [np.repeat(((b.omega > low) & (b.omega <= high))[None], len(b.points), axis=0) for b in rows.batches]
        found.append((f"{max(low, 0.0):.4g} … {high:.4g} rad/s", _spread(rows, chosen)))
    return found


def _classes(rows: Rows) -> list[tuple[str, BoolArray]]:
    found = []
    for number, name in enumerate(CLASS_NAMES):
        chosen = _spread(rows, [batch.classes == number for batch in rows.batches])
        if np.any(chosen & _compared(rows)):
            found.append((name, chosen))
    return found


def _split(found: Fit) -> tuple[TestResult, TestResult, TestResult]:
    """Lack of fit of a refit; likelihood ratio of one LTI model per operating point against it; what those leave.

    Σ_m ‖Q_mᵀ r_m‖² ~ χ²(Σ rank J_m − k),  the rest ~ χ²(R − Σ rank J_m)      [Ghosh2018, Remark 3]
    """
    rows = found.rows
    explained, ranks = 0.0, 0
    local = rows.whiten([np.swapaxes(f.by_coefficients, 0, 1) for f in found.flows])
    for _, chosen in _points(rows):
        basis = orthonormal(local[:, chosen].T)
        explained += float(np.sum((basis.T @ found.residual[chosen]) ** 2))
        ranks += basis.shape[1]
    noise, energy = rows.noise_freedom, float(found.residual @ found.residual)
    rank = round(float(_leverage(found.tangents).sum()))
    refitted = lack_of_fit("lack of fit after a refit", energy, rows.count - rank, noise)
    left = lack_of_fit("one LTI model per operating point", energy - explained, rows.count - ranks, noise)
    return refitted, _dependence(explained, ranks - rank, left, noise), left


def _dependence(explained: float, freedom: int, left: TestResult, noise: float) -> TestResult:
    name = "dependence on the operating point"
    if freedom < 1:
        return TestResult(name, 0.0, 0.0, 1.0)
    p = lack_of_fit(name, explained, freedom, noise).p_value
    if left.degrees_of_freedom > 0 and left.p_value < 0.01:
        ratio = explained / freedom / (left.statistic / left.degrees_of_freedom)
        p = float(fdtrc(freedom, left.degrees_of_freedom, ratio))
    return TestResult(name, explained, float(freedom), p)
