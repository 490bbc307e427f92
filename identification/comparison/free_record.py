"""Records that do not repeat themselves: all their lines, unknown transients, noise that is found along with them."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.adaptation import Adaptation
from identification.comparison.autoregressive import autoregressive_spectrum
from identification.comparison.batch import EXCITED, Batch
from identification.comparison.general_directions import general_directions
from identification.comparison.nuisance import Nuisance
from identification.models.structure import Structure
from identification.places.place import Flow
from identification.signals import TimeRecord

MORE_IN_CONTINUOUS_TIME, MORE_FOR_FILTERS = 3, 4
SHARE_OF_LINES = 8
INTEGRATING = 1e-6


def of_record(m: int, record: TimeRecord) -> Batch:
    """The m-th measurement, a record without a period, as a batch with all its lines; its noise is not known yet."""
    count = len(record)
    u, y = (np.fft.rfft(x)[None] / count for x in (record.input, record.output))
    size = float(np.mean((record.output - record.output.mean()) ** 2)) / count + float(np.finfo(float).tiny)
    omega = np.asarray(2 * np.pi * np.fft.rfftfreq(count, record.sample_time), dtype=np.float64)
    return Batch(
        points=np.array([record.operating_point], dtype=np.float64),
        omega=omega,
        inputs=u,
        outputs=y,
        variances=np.full(u.shape, size),
        classes=np.full(u.shape, EXCITED),
        members=np.array([m]),
        signals=np.asarray(record.input, dtype=np.float64)[None],
        sample_time=record.sample_time,
        held=record.held,
        hold_stated=record.hold is not None,
        channels=record.channels,
        transients=_level(u),
        adaptation=FreeRecord(record.feedback),
    )


@dataclass(frozen=True)
class FreeRecord(Adaptation):
    """A(q) Y = B(q) U + I(q) + A(q) V at all lines of a record, whatever was before it and whether it repeats.

        Y_k = G(ω_k) U_k + Σ_i x_i q_k^i/A(q_k) + c δ_k0 + V_k,   i < max(n_a, n_b + n_k),   q = e^{−jωT}

    exactly [PintelonSchoukens2012, Section 6.3.2; Ljung1999, Section 2.3]; in continuous time A has the poles e^{sT}
    and three coefficients more take up what lies between the samples. The noise is an autoregression: the one whose
    order Schwarz's criterion takes for what is left when the general directions are taken off as well, so that a
    distortion is not called noise. Weighting by 1/|H|² all lines is the prediction-error criterion, so that with the
    noise spectrum estimated along with the model the estimate is the direct one where there is `feedback`
    [Forssell1999].
    """

    feedback: bool = False

    def settled(self, batch: Batch, flow: Flow) -> Batch:
        """Transients by the poles of the model, weights by the noise that is then left."""
        found = replace(batch, transients=_transients(batch, flow), general=None)
        changes = general_directions(flow, 1 if self.feedback else 0)
        for _ in range(2):
            general = _general(found, changes)
            spectra, orders = _noise(found, flow, general)
            half_width = _half_width(len(batch.omega), max(orders))
            freedom = 2.0 * (2 * half_width + 1)
            found = replace(found, variances=spectra, half_width=half_width, raw_freedom=2.0, freedom=freedom)
        return replace(found, general=_general(found, changes).basis)

    def measured_law(self, batch: Batch) -> ComplexArray | None:
        """The output."""
        return batch.outputs if self.feedback else None

    def joined(self, others: "list[FreeRecord]") -> "FreeRecord":
        """The same for all, in the loop if one of them is."""
        return FreeRecord(self.feedback or any(one.feedback for one in others))


def _level(u: ComplexArray) -> ComplexArray:
    constant = np.zeros((len(u), 1, u.shape[1]), dtype=np.complex128)
    constant[:, 0, 0] = 1.0
    return constant


def _transients(batch: Batch, flow: Flow) -> ComplexArray:
    """Φ (M, c, K): powers of q over A, and a constant."""
    structure = flow.setting.structure
    q = np.exp(-1j * batch.omega * (batch.sample_time or 1.0))
    filtered = bool(np.any(flow.linear != flow.core))
    count = structure.transients
    count += 0 if structure.is_discrete else MORE_IN_CONTINUOUS_TIME
    count += MORE_FOR_FILTERS if filtered else 0
    count = min(count, max(len(q) // SHARE_OF_LINES, 1))
    poles = _sampled_poles(structure, flow.setting.zeta, batch.sample_time or 1.0)
    denominator = np.prod(1 - poles[:, None, :] * q[None, :, None], axis=-1)
    near = abs(denominator) < INTEGRATING
    denominator = np.where(near, INTEGRATING, denominator)
    powers = q[None] ** np.arange(count)[:, None]
    return np.concatenate([powers[None] / denominator[:, None, :], _level(batch.inputs)], axis=1)


def _sampled_poles(structure: Structure, zeta: FloatArray, sample_time: float) -> ComplexArray:
    """The poles (M, n_a) in the z-plane."""
    poles = structure.poles(zeta)
    return np.asarray(poles if structure.is_discrete else np.exp(poles * sample_time))


def _general(batch: Batch, changes: ComplexArray) -> Nuisance:
    """The general directions, whitened and without transients, as orthonormal rows of each record."""
    rows = batch.whiten(changes).reshape(len(changes), len(batch.points), -1)
    most = max(rows.shape[-1] // SHARE_OF_LINES, 1)
    return Nuisance.of(np.moveaxis(changes, 0, 1), np.moveaxis(rows, 0, 1)[:, :most])


def _noise(batch: Batch, flow: Flow, general: Nuisance) -> tuple[FloatArray, list[int]]:
    """Variances (M, K) and the orders of the noise of each record."""
    assert batch.signals is not None
    samples = batch.signals.shape[1]
    rows = batch.whiten(batch.outputs - flow.output).reshape(len(batch.points), -1)
    left = general.taken_out(rows).reshape(len(rows), 2, -1)
    weights = batch.weights_of_rows
    parts = np.where(weights > 0, left / np.where(weights > 0, weights, 1.0), 0.0)
    powers = np.sum(parts**2, axis=1)
    taken = general.counts + (0 if batch.transients is None else batch.transients.shape[1])
    found = [autoregressive_spectrum(one, samples) for one in powers]
    floor = 1e-26 * np.mean(abs(batch.outputs) ** 2, axis=1) + float(np.finfo(np.float64).tiny)
    lost = samples / np.maximum(samples - taken, 1.0)
    spectra = np.stack([spectrum for spectrum, _ in found]) * lost[:, None]
    spectra = np.maximum(spectra, floor[:, None]) * np.where(batch.real, 2.0, 1.0)
    return spectra, [order for _, order in found]


def _half_width(lines: int, order: int) -> int:
    """An autoregression of order n has one degree of freedom for every (n + 1)-th of the lines."""
    return max(min((lines - 3) // 2, lines // (2 * order + 2)), 0)
