"""Measurements on a common frequency grid, ready to be compared with a model line by line."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.channels import UNSTATED, Channels
from identification.comparison.adaptation import Adaptation
from identification.comparison.disturbance import Disturbance
from identification.comparison.nuisance import Nuisance
from identification.signals import HeldInput

EXCITED, ODD, EVEN = 0, 1, 2
NEGLIGIBLE, SMALLEST = 0.1, 0.2
CLASS_NAMES = ("excited", "unexcited odd", "unexcited even")
EACH = ("points", "inputs", "variances", "classes", "members", "signals", "ends", "nuisance", "scatter")


@dataclass(frozen=True, eq=False)
class Batch:
    """M measurements with the same K lines: mean spectra over the steady periods, or frequency responses (U = 1).

        x(t) = Σ_k X_k e^{jω_k t},   so that X = rfft(x)/L for a period of L samples;   r = √2 (Re, Im)(Y − Ŷ)/σ

    `points` (M, s); `omega` (K,) rad/s; `inputs`, `outputs` (M, K) in the units of the plant; `variances` (M, K)
    E|n|² of the noise on `outputs` (twice that of the real number at ω = 0 and the Nyquist frequency), infinite for
    lines that are not compared; `classes` (M, K) of EXCITED, ODD, EVEN; `freedom` (K,) real degrees of freedom of
    each σ̂², `raw_freedom` those that one line brings by itself (infinite where σ is known exactly); windows of 2
    `half_width` + 1 lines were pooled. `signals` (M, L) the input over one period, None for frequency responses.
    `nuisance` (M, n, L): signals of any size in the mean period, such as a slow trend, which are not compared; rows
    of zeros where there are fewer. `ends` (M, 2, L): what correlated noise at the ends of a record does to the mean
    period, see `noise.NoiseOfMean`. `varied` (M, n, K): changes of the output that each record has by a random
    factor of unit variance. `slopes` (M, K): Σ c_p Y_p with c_p ∝ p − (P + 1)/2 and Σ c_p² = 1/P, how the P periods
    change from first to last, with the variance of the mean. `scaled`: False when only the ratios of the variances
    are known. `members`: places in the user's list. `logged`: quantities (M,) that were written down beside the
    scheduling variables, by their names. `disturbances`: of each record, taken off the outputs; `smoothed`: whether
    the responses stand for records that do not repeat; `notes`: what else is to be said of measurements, by their
    place in the list. `held`: how models in continuous time see the input, None where it is band limited;
    `hold_stated`: that was said. `channels`: what input and output are.

    A record that does not repeat itself stands here with all its lines, L being its length, as Y = G U + Φ x + V:
    `transients` Φ (M, c, K), whose real coefficients x are unknown, are taken out of all rows. `general` (M, d, 2K):
    orthonormal whitened rows of what any model could have missed; lack of fit is then judged there and the noise is
    what they leave. `adaptation`: how the batch follows from the model; None where it does not. `measured_law` (M, K):
    the output from which forces that effects feed back are computed in place of the simulated one.

    The periods that are compared begin `begun` (M,) seconds after the start of the record, and `averaged` is how many
    they are. `drift`: the share by which the clock of the outputs was seen to run faster, zero where it was not;
    `parts` (M, P, K): each of the periods then, see `in_parts`. `scatter` (M, 2): see `scatter_with_rate`.

    Of responses with several inputs and outputs each path is a row: `ports` (M, 2) its output and input, those of one
    measurement one after the other, of `shape` n_y × n_u. `decoupling` (M/c, K, c, c) turns the c rows of a measurement
    into such whose noise is uncorrelated, of the same variances; `coupled`: how many outputs one estimate of the
    covariance holds.
    """

    points: FloatArray
    omega: FloatArray
    inputs: ComplexArray
    outputs: ComplexArray
    variances: FloatArray
    classes: IntArray
    members: IntArray
    signals: FloatArray | None = None
    sample_time: float | None = None
    freedom: float = np.inf
    raw_freedom: float = np.inf
    half_width: int = 0
    ends: FloatArray | None = None
    nuisance: FloatArray | None = None
    varied: ComplexArray | None = None
    slopes: ComplexArray | None = None
    scaled: bool = True
    between: tuple[FloatArray, ...] = field(default=())
    disturbances: tuple[tuple[Disturbance, ...], ...] = ()
    smoothed: bool = False
    notes: tuple[tuple[int, str], ...] = ()
    logged: Mapping[str, FloatArray] = field(default_factory=dict)
    held: HeldInput | None = None
    hold_stated: bool = False
    channels: Channels = UNSTATED
    transients: ComplexArray | None = None
    general: FloatArray | None = None
    adaptation: Adaptation | None = None
    measured_law: ComplexArray | None = None
    begun: FloatArray | None = None
    averaged: int = 1
    parts: ComplexArray | None = None
    drift: float = 0.0
    scatter: FloatArray | None = None
    ports: IntArray | None = None
    shape: tuple[int, int] = (1, 1)
    decoupling: ComplexArray | None = None
    coupled: int = 1

    @cached_property
    def real(self) -> BoolArray:
        """Which of the lines (K,) hold one real number only."""
        at_nyquist = np.zeros(len(self.omega), dtype=np.bool_)
        if self.sample_time is not None:
            at_nyquist = abs(self.omega * self.sample_time / np.pi - 1) < 1e-9
        return np.asarray((self.omega == 0) | at_nyquist)

    @cached_property
    def weights(self) -> FloatArray:
        """√2/σ (M, K), less what the randomness of σ̂ adds to the mean of r²: E r² = 1."""
        inflation = 1.0 if np.isinf(self.freedom) else self.freedom / (self.freedom - 2 * self.coupled)
        return np.sqrt(2 / (self.variances * inflation))

    @cached_property
    def weights_of_rows(self) -> FloatArray:
        """The weights of real and imaginary parts, (M, 2, K); the imaginary part of a real line has none."""
        imaginary = np.where(self.real, 0.0, self.weights)
        return np.stack([self.weights, imaginary], axis=1)

    @cached_property
    def compared(self) -> BoolArray:
        """Which rows of the whitened residual carry information, (M·2·K,)."""
        return np.asarray(self.weights_of_rows.ravel() > 0)

    @property
    def row_count(self) -> int:
        """How many real numbers are compared, less those that nuisances and transients take up."""
        taken = 0 if (found := self._of_nuisance) is None else int(np.sum(found[1] < 0))
        transients = 0 if self._span is None else round(float(self._span.counts.sum()))
        return int(self.compared.sum()) - taken - transients

    def in_parts(self) -> "Batch":
        """With each part as a measurement where the phases of the periods drift, its variance as it has fewer."""
        if self.parts is None:
            return self
        assert self.begun is not None
        assert self.signals is not None
        assert self.sample_time is not None
        count, duration = self.parts.shape[1], self.signals.shape[-1] * self.sample_time
        own, skipped = divmod(self.averaged, count)
        each = {name: getattr(self, name) for name in EACH if getattr(self, name) is not None}
        repeated: dict[str, Any] = {name: np.repeat(value, count, axis=0) for name, value in each.items()}
        for name in ("variances", "ends"):
            repeated[name] = self.averaged / own * repeated[name]
        begun = (self.begun[:, None] + duration * (skipped + own * np.arange(count))).ravel()
        return replace(
            self,
            **repeated,
            outputs=self.parts.reshape(-1, len(self.omega)),
            logged={name: np.repeat(value, count) for name, value in self.logged.items()},
            begun=begun,
            averaged=own,
            parts=None,
            slopes=None,
        )

    @property
    def repeats(self) -> bool:
        """Whether the signals are periods: False for records whose end does not lead back to their start."""
        return self.transients is None

    @cached_property
    def _span(self) -> Nuisance | None:
        if self.transients is None:
            return None
        whitened = self._weighted(np.moveaxis(self.transients, 1, 0))
        return Nuisance.of(self.transients, np.moveaxis(whitened, 0, 1))

    def transient(self, moved: ComplexArray) -> ComplexArray:
        """Φ x (M, K) that brings the answer `moved` (M, K) of a model nearest to the measured output; zero if none."""
        if self._span is None:
            return np.zeros_like(moved)
        return self._span.fitted(self._weighted(self.outputs - moved))

    def whiten(self, spectra: ComplexArray) -> FloatArray:
        """Spectra (…, M, K) as uncorrelated rows of unit variance (…, M·2·K): real, then imaginary parts by record."""
        rows = self._weighted(spectra)
        for found in (self._jumps, self._of_varied):
            if found is not None:
                directions, factors = found
                part = np.einsum("...mr,mir->...mi", rows, directions) * factors
                rows += np.einsum("...mi,mir->...mr", part, directions)
        if self._span is not None:
            rows = self._span.taken_out(rows)
        return rows.reshape(*spectra.shape[:-2], -1)

    @cached_property
    def _of_varied(self) -> tuple[FloatArray, FloatArray] | None:
        """Axes of I + B Bᵀ, B the whitened random changes of each record, and v^−½ − 1 (M, n)."""
        if self.varied is None:
            return None
        rows = np.moveaxis(replace(self, varied=None)._unfolded(np.moveaxis(self.varied, 1, 0)), 0, 1)
        _, sizes, axes = np.linalg.svd(rows, full_matrices=False)
        return axes, (1 + sizes**2) ** -0.5 - 1

    @property
    def log_determinant(self) -> float:
        """ln det of the variance with what varies from record to record, against that without."""
        return 0.0 if self._of_varied is None else float(-2 * np.sum(np.log1p(self._of_varied[1])))

    def _unfolded(self, spectra: ComplexArray) -> FloatArray:
        """Whitened rows by record, (…, M, 2K)."""
        return self.whiten(spectra).reshape(*spectra.shape[:-1], -1)

    def _weighted(self, spectra: ComplexArray) -> FloatArray:
        if self.decoupling is not None:
            spectra = self._decoupled(spectra, self.decoupling)
        rows = np.empty((*spectra.shape[:-1], 2, spectra.shape[-1]))
        rows[..., 0, :] = spectra.real
        rows[..., 1, :] = spectra.imag
        rows *= self.weights_of_rows
        return rows.reshape(*spectra.shape[:-1], -1)

    def _decoupled(self, spectra: ComplexArray, by: ComplexArray) -> ComplexArray:
        count, lines, rows, _ = by.shape
        each = np.moveaxis(spectra.reshape(*spectra.shape[:-2], count, rows, lines), -1, -2)
        return np.moveaxis((by @ each[..., None])[..., 0], -1, -2).reshape(spectra.shape)

    @cached_property
    def _jumps(self) -> tuple[FloatArray, FloatArray] | None:
        """Unit directions q (M, n, 2K) in which weighted noise has the variance v, and v^−½ − 1 (M, n).

        −(ℓ ℓ'ᵀ + ℓ' ℓᵀ) = ½ (ℓ − ℓ')(ℓ − ℓ')ᵀ − ½ (ℓ + ℓ')(ℓ + ℓ')ᵀ, and infinite v in the directions of `nuisance`;
        None where noise is nearly white and nothing is a nuisance.
        """
        parts = [part for part in (self._of_ends, self._of_nuisance) if part is not None]
        if not parts:
            return None
        return np.concatenate([part[0] for part in parts], axis=1), np.concatenate([part[1] for part in parts], axis=1)

    @property
    def _of_ends(self) -> tuple[FloatArray, FloatArray] | None:
        if self.ends is None:
            return None
        jumps = np.stack([self.ends[:, 0] - self.ends[:, 1], self.ends[:, 0] + self.ends[:, 1]]) * np.sqrt(0.5)
        rows = np.moveaxis(self._weighted(self.spectrum(jumps)), 0, 1)
        excess = np.sum(rows**2, axis=-1)
        if np.max(excess) < NEGLIGIBLE:
            return None
        variance = np.maximum(1 + excess * np.array([1.0, -1.0]), SMALLEST)
        return rows / np.sqrt(np.maximum(excess, np.finfo(float).tiny))[..., None], variance**-0.5 - 1

    @property
    def _of_nuisance(self) -> tuple[FloatArray, FloatArray] | None:
        if self.nuisance is None or not self.nuisance.size:
            return None
        rows = np.moveaxis(self._weighted(self.spectrum(np.moveaxis(self.nuisance, 1, 0))), 0, 1)
        _, sizes, directions = np.linalg.svd(rows, full_matrices=False)
        kept = sizes > 1e-9 * np.maximum(sizes[:, :1], np.finfo(float).tiny)
        return directions * kept[..., None], -1.0 * kept

    @cached_property
    def measured(self) -> FloatArray:
        """The whitened measurement, (M·2·K,)."""
        return self.whiten(self.outputs)

    def complex_residual(self, rows: FloatArray) -> ComplexArray:
        """Whitened rows (M·2·K,) as complex numbers (M, K) with E|z|² = 1 (at real lines 1 for the real part)."""
        parts = rows.reshape(len(self.points), 2, len(self.omega))
        scale = np.where(self.real, 1.0, np.sqrt(0.5))
        return np.asarray(scale * (parts[:, 0] + 1j * parts[:, 1]))

    @cached_property
    def followed(self) -> ComplexArray | None:
        """The output that laws follow (M, K), each line by its share of signal: Y_k max(1 − σ_k²/|Y_k|², 0)."""
        if self.measured_law is None:
            return None
        power = abs(self.measured_law) ** 2
        noise = np.where(np.isfinite(self.variances), self.variances, 0.0)
        share = np.maximum(1 - noise / np.where(power > 0, power, 1.0), 0.0)
        return np.asarray(np.where(power > 0, share, 0.0) * self.measured_law)

    def spectrum(self, signals: FloatArray) -> ComplexArray:
        """Lines (…, K) of signals (…, L·n) over one period."""
        lines = np.fft.rfft(signals)[..., : len(self.omega)]
        return np.asarray(lines / signals.shape[-1])

    def signal(self, spectra: ComplexArray, finer: int = 1) -> FloatArray:
        """One period (…, L·`finer`) of signals with lines (…, K), the time grid finer by that factor."""
        assert self.signals is not None
        length = self.signals.shape[-1] * finer
        if finer > 1 and not self.repeats:
            return with_free_ends(self.signal(spectra), finer)
        if finer > 1:
            spectra = spectra * np.where(self.real & (self.omega > 0), 0.5, 1.0)
        return np.asarray(np.fft.irfft(spectra * length, n=length))

    def rate(self, spectra: ComplexArray, finer: int = 1) -> FloatArray:
        """The time derivative (…, L·`finer`) per second of such signals; the Nyquist line has none."""
        assert self.signals is not None
        if not self.repeats:
            assert self.sample_time is not None
            return with_free_ends(self.signal(spectra), finer, self.sample_time)
        omega = np.where(self.real, 0.0, self.omega)
        return self.signal(np.asarray(1j * omega * spectra), finer)

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest excited frequency above zero, rad/s."""
        excited = self.omega[np.any((self.classes == EXCITED) & np.isfinite(self.variances), axis=0) & (self.omega > 0)]
        return float(excited.min()), float(excited.max())


def with_free_ends(x: FloatArray, finer: int, sample_time: float | None = None) -> FloatArray:
    """Signals (…, L) on a grid `finer` times as fine, or their rate of change with a `sample_time`, (…, L·finer).

    A straight line is taken out first, so that the ends meet and the lines of what is left fall off fast.
    """
    length = x.shape[-1]
    slope = (x[..., -1:] - x[..., :1]) / (length - 1)
    lines = np.fft.rfft(x - slope * np.arange(length))
    if length % 2 == 0:
        lines[..., -1] *= 0.5 if finer > 1 else 1.0
    line = slope * (np.arange(length * finer) / finer)
    if sample_time is not None:
        omega = 2 * np.pi * np.fft.rfftfreq(length, sample_time)
        omega[-1] *= length % 2
        lines, line = 1j * omega * lines, slope / sample_time
    return np.asarray(np.fft.irfft(lines * finer, n=length * finer) + line)
