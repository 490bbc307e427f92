"""First estimates of θ straight from all experiments, where some alone cannot identify a local model."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import qr

from identification.arrays import ComplexArray, FloatArray
from identification.lti.box_jenkins_start import autoregression, disturbance, high_order_model, reflected
from identification.lti.filtering import lfilter
from identification.lti.likelihood import delayed
from identification.models.hold import without_hold
from identification.models.physical import RationalForm
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, Measurement, TimeRecord

ONE = np.ones(1)
DELAYS_TRIED = 8


def pooled_starts(
    structure: RationalForm, transfer: FloatArray, experiments: Sequence[Measurement], rounds: int = 6
) -> list[FloatArray]:
    """Stable first estimates θ (k,) for T(p_m) (M, n, k): a Steiglitz–McBride iteration that is linear in θ.

        Σ_m ‖W_m (A(q, T_m θ) y_m − B(q, T_m θ) u_m)‖² / |A(q, T_m θ_prev)|²  →  min over θ_G

    W_m whitens a record by an autoregressive model of high order and weighs a frequency response by its deviations;
    there u_m = 1 and y_m is the response. The noise model follows from a regression of what is left on its own past
    and on past innovations, linear in θ_H. Estimates unstable at an operating point have their poles drawn in.
    """
    found = []
    for tau in _delays(structure, experiments):
        for whitened in (True, False):
            parts = [_Rows(structure, T, e, tau, whitened) for T, e in zip(transfer, experiments, strict=True)]
            for plant in _iterate(structure, transfer, parts, tau, rounds):
                noisy = _with_noise(structure.plain, transfer, experiments, plant)
                stable = _drawn_in(structure, transfer, noisy)
                found.extend([stable] if stable is not None and np.all(np.isfinite(stable)) else [])
    return found


def _delays(structure: RationalForm, experiments: Sequence[Measurement]) -> list[float]:
    if not structure.delay:
        return [0.0]
    lines = [np.sort(e.frequencies) for e in experiments if isinstance(e, FrequencyResponse)]
    spacing = [float(np.diff(each).min()) for each in lines if len(each) > 1]
    highest = max((float(each[-1]) for each in lines), default=1.0)
    longest = min(np.pi / min(spacing, default=np.pi), 40 / max(highest, np.finfo(float).tiny))
    return list(np.linspace(0.0, longest, DELAYS_TRIED))


class _Rows:
    """The linear equations in θ that one experiment contributes, weighted with the denominator of the round before."""

    def __init__(
        self, structure: RationalForm, transfer: FloatArray, data: Measurement, tau: float, whitened: bool
    ) -> None:
        self.structure, self.transfer, self.data, self.tau = structure, transfer, data, tau
        self.whitener = ONE
        if isinstance(data, TimeRecord) and whitened and structure.n_noise:
            order = min(25, max(len(data) // 6, 1))
            self.whitener = high_order_model(structure.plain, data, order).denominator

    def equations(self, theta: FloatArray | None) -> tuple[FloatArray, FloatArray]:
        """Columns (R, k) and target (R,)."""
        if isinstance(self.data, TimeRecord):
            columns, target = self._of_record(self.data, theta)
        else:
            columns, target = self._of_response(self.data, theta)
        return columns @ self.transfer[: columns.shape[1]], target

    def _of_record(self, record: TimeRecord, theta: FloatArray | None) -> tuple[FloatArray, FloatArray]:
        s = self.structure.plain
        denominator = ONE
        if theta is not None:
            denominator = reflected(np.concatenate([ONE, (self.transfer @ theta)[: s.n_a]]))
        y, u = lfilter(self.whitener, ONE, np.stack([record.output, record.input]))
        pulse = np.eye(len(record), 1).ravel()
        y, u, pulse = lfilter(ONE, denominator, np.stack([y, u, pulse]))
        columns = np.concatenate([-delayed(y, 1, s.n_a), delayed(u, s.n_k, s.n_b + 1)], axis=1)
        start = qr(delayed(pulse, 0, s.n_a + len(self.whitener) - 1), mode="economic", check_finite=False)[0]
        return columns - start @ (start.T @ columns), y - start @ (start.T @ y)

    def _of_response(self, data: FrequencyResponse, theta: FloatArray | None) -> tuple[FloatArray, FloatArray]:
        a_0, a, b_0, b = self.structure.affine(data.frequencies)
        weights = 1 / np.sqrt(data.variance) if data.variance is not None else np.ones(len(data))
        weights = weights.astype(np.complex128)
        if theta is not None:
            weights = weights / abs(a_0 + (self.transfer @ theta)[: len(a)] @ a)
        response = without_hold(data) * np.exp(1j * data.frequencies * self.tau)
        return _real(weights * (b - response * a)).T, _real(weights * (response * a_0 - b_0))


def _real(values: ComplexArray) -> FloatArray:
    return np.concatenate([values.real, values.imag], axis=-1)


def _iterate(
    structure: RationalForm, transfer: FloatArray, parts: Sequence[_Rows], tau: float, rounds: int
) -> Iterator[FloatArray]:
    """θ (k,) after each of the last rounds, with zeros for H and, where there is a delay, τ the same everywhere."""
    theta: FloatArray | None = None
    for i in range(rounds):
        columns, targets = zip(*(part.equations(theta) for part in parts), strict=True)
        theta = _solve(np.concatenate(columns), np.concatenate(targets))
        if structure.delay:
            of_tau = transfer[:, structure.n_plant - 1, :]
            theta = theta + np.linalg.lstsq(of_tau, np.full(len(of_tau), tau), rcond=1e-12)[0]
        if i in (0, rounds - 2, rounds - 1):
            yield theta


def _with_noise(
    structure: RationalStructure, transfer: FloatArray, experiments: Sequence[Measurement], theta: FloatArray
) -> FloatArray:
    """θ with θ_H from the regression v = Σ c_i e(t − i) − Σ d_i v(t − i) + e over all records."""
    if structure.n_noise == 0:
        return theta
    columns, targets = [], []
    for T, data in zip(transfer, experiments, strict=True):
        if isinstance(data, TimeRecord):
            plant = (T @ theta)[: structure.n_plant]
            denominator = reflected(np.concatenate([ONE, plant[: structure.n_a]]))
            plant = np.concatenate([denominator[1:], plant[structure.n_a :]])
            v = disturbance(structure, plant, data)
            e = lfilter(autoregression(v), ONE, v)
            regressors = np.concatenate([delayed(e, 1, structure.n_c), -delayed(v, 1, structure.n_d)], axis=1)
            deviation = np.std(e) or 1.0
            columns.append(regressors @ T[structure.n_plant :] / deviation)
            targets.append(v / deviation)
    return theta + _solve(np.concatenate(columns), np.concatenate(targets))


def _solve(columns: FloatArray, target: FloatArray) -> FloatArray:
    scale = np.linalg.norm(columns, axis=0)
    scale = np.where(scale > 0, scale, np.inf)
    return np.asarray(np.linalg.lstsq(columns / scale, target, rcond=1e-11)[0] / scale)


def _drawn_in(structure: RationalForm, transfer: FloatArray, theta: FloatArray) -> FloatArray | None:
    """θ with all zeros of A, C, D drawn towards the origin until every operating point is stable.

    In discrete time i-th coefficients are multiplied by λ^i, which multiplies every zero by λ; in continuous time the
    poles of each operating point are mirrored and θ fitted to the result. None when that does not help.
    """
    if np.all(structure.stable(transfer @ theta)):
        return theta
    if not structure.is_discrete:
        return _mirrored(structure, transfer, theta)
    for factor in (0.999, 0.99, 0.97, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2, 0.0):
        shrunk = shrunk_zeros(structure.plain, transfer, theta, factor)
        if np.all(structure.stable(transfer @ shrunk)):
            return shrunk
    return None


def shrunk_zeros(structure: RationalStructure, transfer: FloatArray, theta: FloatArray, factor: float) -> FloatArray:
    """θ (k,) with every zero of A, C and D multiplied by a factor at all operating points, in discrete time."""
    powers = np.zeros(structure.size)
    for first, count in ((0, structure.n_a), (structure.n_plant, structure.n_c)):
        powers[first : first + count] = np.arange(1, count + 1)
    powers[structure.n_plant + structure.n_c :] = np.arange(1, structure.n_d + 1)
    size = np.abs(transfer).sum(axis=0)
    exponents = powers[np.argmax(size, axis=0)]
    return np.asarray(theta * factor**exponents)


def _mirrored(structure: RationalForm, transfer: FloatArray, theta: FloatArray) -> FloatArray | None:
    plain = structure.to_plain(transfer @ theta)
    for row in plain:
        poles = structure.plain.poles(row) / structure.frequency_scale
        mirrored = -np.maximum(abs(poles.real), 1e-3 * abs(poles)) + 1j * poles.imag
        row[: structure.n_a] = np.poly(mirrored).real[1:]
    matrix = transfer.reshape(-1, transfer.shape[-1])
    fitted = _solve(matrix, structure.of_plain(plain).ravel())
    return fitted if np.all(structure.stable(transfer @ fitted)) else None
