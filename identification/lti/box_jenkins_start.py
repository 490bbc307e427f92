"""First estimates of the Box–Jenkins family from linear least squares only, for a search that needs no luck."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr

from identification.arrays import FloatArray
from identification.lti.filtering import lfilter
from identification.lti.likelihood import delayed
from identification.models.rational import RationalStructure, roots
from identification.signals import TimeRecord

ONE = np.ones(1)


@dataclass(frozen=True, eq=False)
class HighOrderModel:
    """A_h y = B_h u + e of high order: a (p,), b (p,) minimise ‖R (a, b) − z‖ with R (2p, 2p) triangular, z (2p,)."""

    a: FloatArray
    b: FloatArray
    factor: FloatArray
    target: FloatArray

    @property
    def denominator(self) -> FloatArray:
        """A_h with its leading one, (p + 1,)."""
        return np.concatenate([ONE, self.a])


def waves(structure: RationalStructure, record: TimeRecord) -> Iterator[list[FloatArray]]:
    """Stable first estimates ζ (n,) of a record in two waves, the quick ones first.

    Weighted null-space fitting of two high-order models [Galrinho2018]; then Steiglitz–McBride iterations on data
    that are whitened by the high-order model, by nothing, and by an autoregression of the remaining disturbance.
    """
    largest = max(structure.n_a, structure.n_b + 1, structure.n_c, structure.n_d)
    limit = max(len(record) // 6, 1)
    model = high_order_model(structure, record, min(max(3 * largest, 25), limit))
    quick = [*weighted_null_space(structure, model), *weighted_null_space(structure, truncated(model, largest + 4))]
    yield _stable_and_finite(structure, quick)
    longer = high_order_model(structure, record, min(max(5 * largest, 60), limit))
    slow = [*weighted_null_space(structure, longer), *_by_iteration(structure, record, model)]
    yield _stable_and_finite(structure, slow)


def _stable_and_finite(structure: RationalStructure, estimates: list[FloatArray]) -> list[FloatArray]:
    return [_stable(structure, zeta) for zeta in estimates if np.all(np.isfinite(zeta))]


def _by_iteration(structure: RationalStructure, record: TimeRecord, model: HighOrderModel) -> Iterator[FloatArray]:
    whitener = model.denominator
    for following in range(3):
        plants = list(steiglitz_mcbride(structure, record, whitener))
        yield with_noise_model(structure, record, plants[-1])
        if structure.n_noise == 0:
            yield from plants[:-1]
        whitener = ONE if following == 0 else autoregression(disturbance(structure, plants[-1], record))


def high_order_model(structure: RationalStructure, record: TimeRecord, order: int) -> HighOrderModel:
    """The least-squares estimate of A_h y = B_h u + e, the first samples left out so that no start state matters."""
    y, u = record.output, record.input
    skipped = order + structure.n_k
    columns = [-delayed(y, 1, order), delayed(u, structure.n_k, order), y[:, None]]
    factor = _triangle(np.concatenate(columns, axis=1)[skipped:])
    return _from_factor(factor, order)


def _triangle(matrix: FloatArray) -> FloatArray:
    factor = np.asarray(qr(matrix, mode="r", check_finite=False)[0], dtype=np.float64)
    return factor[: matrix.shape[1]]


def _from_factor(factor: FloatArray, order: int) -> HighOrderModel:
    rows = np.zeros((2 * order, 2 * order + 1))
    rows[: len(factor)] = factor[: 2 * order]
    eta = np.asarray(np.linalg.lstsq(rows[:, :-1], rows[:, -1], rcond=1e-10)[0], dtype=np.float64)
    return HighOrderModel(eta[:order], eta[order:], rows[:, :-1], rows[:, -1])


def truncated(model: HighOrderModel, order: int) -> HighOrderModel:
    """The least-squares estimate of a lower order from the same data."""
    p = len(model.a)
    kept = np.arange(min(order, p))
    columns = model.factor[:, np.concatenate([kept, p + kept])]
    factor = _triangle(np.column_stack([columns, model.target]))
    return _from_factor(factor, len(kept))


def weighted_null_space(structure: RationalStructure, model: HighOrderModel, rounds: int = 4) -> list[FloatArray]:
    """Estimates ζ (n,) from the polynomial identities that hold for the true high-order model [Galrinho2018].

        C A_h − D = 0,   A B_h − B A_h = 0,   errors of the first kind C δ_a, of the second A δ_b − B δ_a

    Each round weighs the identities with the covariance (RᵀR)⁻¹ of (δ_a, δ_b) at the estimate of the round before.
    """
    regressors, target = _identities(structure, model)
    zeta, found = np.zeros(structure.size), []
    for _ in range(rounds):
        weighted = _weighted(structure, zeta, np.column_stack([regressors, target]), model)
        solution = np.linalg.lstsq(weighted[:, :-1], weighted[:, -1], rcond=1e-12)[0]
        zeta = _stable(structure, np.asarray(solution, dtype=np.float64))
        found.append(zeta)
    return found[-2:]


def _identities(structure: RationalStructure, model: HighOrderModel) -> tuple[FloatArray, FloatArray]:
    p, one = len(model.a), model.denominator
    zeros = np.zeros
    pulse = np.eye(p + 1, 1).ravel()
    noise = [delayed(one, 1, structure.n_c), -delayed(pulse, 1, structure.n_d)]
    plant = [delayed(model.b, 1, structure.n_a), -delayed(one[:p], 0, structure.n_b + 1)]
    top = np.concatenate([zeros((p, structure.n_plant)), np.concatenate(noise, axis=1)[1:]], axis=1)
    bottom = np.concatenate([*plant, zeros((p, structure.n_noise))], axis=1)
    return np.concatenate([top, bottom]), -np.concatenate([model.a, model.b])


def _weighted(
    structure: RationalStructure, zeta: FloatArray, identities: FloatArray, model: HighOrderModel
) -> FloatArray:
    p = len(model.a)
    a, b, _, c, _ = structure.split(zeta)
    of_a = lfilter(ONE, np.concatenate([ONE, c]), identities[:p], axis=0)
    shifted = np.concatenate([np.zeros((1, of_a.shape[1])), of_a[:-1]])
    of_b = lfilter(ONE, np.concatenate([ONE, a]), identities[p:] + lfilter(b, ONE, shifted, axis=0), axis=0)
    return np.asarray(model.factor @ np.concatenate([of_a, of_b]))


def steiglitz_mcbride(
    structure: RationalStructure, record: TimeRecord, whitener: FloatArray, rounds: int = 5
) -> Iterator[FloatArray]:
    """Plants ζ_G (n_plant,) from A (W y/A₀) = B (W u/A₀), A₀ of the round before and W the whitening filter.

    Pulses at the start of the record take up the response to its unknown initial state.
    """
    y, u = lfilter(whitener, ONE, np.stack([record.output, record.input]))
    pulse = np.eye(len(record), 1).ravel()
    denominator = ONE
    for _ in range(rounds):
        y_f, u_f, pulse_f = lfilter(ONE, denominator, np.stack([y, u, pulse]))
        columns = [
            -delayed(y_f, 1, structure.n_a),
            delayed(u_f, structure.n_k, structure.n_b + 1),
            delayed(pulse_f, 0, structure.n_a + len(whitener) - 1),
        ]
        plant = _least_squares(np.concatenate(columns, axis=1), y_f)[: structure.n_plant]
        denominator = reflected(np.concatenate([ONE, plant[: structure.n_a]]))
        yield np.concatenate([denominator[1:], plant[structure.n_a :]])


def with_noise_model(structure: RationalStructure, record: TimeRecord, plant: FloatArray) -> FloatArray:
    """ζ (n,) of a plant ζ_G with H fitted to what the plant leaves over (Hannan–Rissanen)."""
    if structure.n_noise == 0:
        return plant
    noise = arma(disturbance(structure, plant, record), structure.n_c, structure.n_d)
    return np.concatenate([plant, noise])


def disturbance(structure: RationalStructure, plant: FloatArray, record: TimeRecord) -> FloatArray:
    """y − G u from rest, (N,)."""
    a, b = plant[: structure.n_a], plant[structure.n_a : structure.n_plant]
    return record.output - lfilter(np.concatenate([np.zeros(structure.n_k), b]), np.concatenate([ONE, a]), record.input)


def arma(signal: FloatArray, n_c: int, n_d: int, rounds: int = 3) -> FloatArray:
    """(c_1 …, d_1 …) of D v = C e for a signal v (N,): e from a long autoregression, then least squares, then again."""
    innovations = lfilter(autoregression(signal), ONE, signal)
    c, d = np.zeros(n_c), np.zeros(n_d)
    for _ in range(rounds):
        inverse = np.concatenate([ONE, c])
        v, e = lfilter(ONE, inverse, np.stack([signal, innovations]))
        target = v + (lfilter(inverse, ONE, e) - e) if n_c else v
        columns = np.concatenate([delayed(e, 1, n_c), -delayed(v, 1, n_d)], axis=1)
        solution = _least_squares(columns, target)
        c, d = (reflected(np.concatenate([ONE, part]))[1:] for part in (solution[:n_c], solution[n_c:]))
        innovations = lfilter(np.concatenate([ONE, d]), np.concatenate([ONE, c]), signal)
    return np.concatenate([c, d])


def autoregression(signal: FloatArray, order: int | None = None) -> FloatArray:
    """The whitening filter (1, a_1, …, a_p) of a signal (N,), by least squares; p defaults to 2 log₂ N."""
    p = min(order or int(2 * np.log2(len(signal))), max(len(signal) // 4, 1))
    if not np.any(signal):
        return ONE
    past = delayed(signal, 1, p)[p:]
    return reflected(np.concatenate([ONE, _least_squares(-past, signal[p:])]))


def reflected(polynomial: FloatArray, radius: float = 0.9995) -> FloatArray:
    """A monic polynomial in q^{-1} with its zeros brought inside the circle of a radius, outside ones by reflection."""
    zeros = roots(polynomial[1:])
    size = abs(zeros)
    if size.max(initial=0.0) <= radius:
        return polynomial
    inside = np.where(size > 1, zeros / np.maximum(size, 1.0) ** 2, zeros)
    inside *= np.minimum(1.0, radius / np.maximum(abs(inside), np.finfo(float).tiny))
    return np.asarray(np.poly(inside).real)


def _stable(structure: RationalStructure, zeta: FloatArray) -> FloatArray:
    a, b, _, c, d = structure.split(zeta)
    inside = [reflected(np.concatenate([ONE, part]))[1:] for part in (a, c, d)]
    return np.concatenate([inside[0], b, inside[1], inside[2]])


def _least_squares(columns: FloatArray, target: FloatArray) -> FloatArray:
    scale = np.linalg.norm(columns, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    return np.asarray(np.linalg.lstsq(columns / scale, target, rcond=1e-12)[0] / scale)
