"""A model held against a record along varying scheduling: residuals over time and frequency, and tests."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from identification.along import output_changes
from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.lack_of_fit import lack_of_fit
from identification.errors import MisuseError
from identification.lti.whiteness import chi_square, orthonormal
from identification.models.model import Model
from identification.models.state_space_model import functions_along
from identification.outcome import TestResult
from identification.varying.correlation_assumptions import noise_tests
from identification.varying.harmonic_noise import LEAST_LINES
from identification.varying.periodic_residuals import PeriodicResiduals
from identification.varying.records import VaryingRecord, steady_periods
from identification.varying.reproduction import reproduced

BANDS = 6
LAGS = 20
MOST_VALUES = 20_000_000
LEFT = 1e-3


@dataclass(frozen=True, eq=False)
class VaryingComparison:
    """What a comparison with one record found.

    `lack_of_fit` of the spectrum of the mean period against the noise between the harmonics, and `by_band` of it with
    the `edges` (bands + 1,) rad/s; None and empty for a record that is not synchronised. `tests` of the simulation
    error e = y − ŷ: white and normal, and independent of past input and scheduling. `residual` z (F, n_y) at
    `frequencies` rad/s and `errors` (N, n_y) over time, both in units of the deviation of the noise where it is known
    (`noise_known`), else of their own. `best_fit_rate`, `variance_accounted_for` in %.
    """

    best_fit_rate: float
    variance_accounted_for: float
    noise_known: bool
    lack_of_fit: TestResult | None
    by_band: tuple[TestResult, ...]
    edges: FloatArray
    tests: tuple[TestResult, ...]
    frequencies: FloatArray
    residual: ComplexArray
    errors: FloatArray


def compare_varying(
    model: Model,
    record: VaryingRecord,
    fitted: bool,
    noise_covariance: FloatArray | None = None,
    drop_periods: int | None = None,
    tolerance: float = 1e-6,
) -> VaryingComparison:
    """Hold a model against a record, the one that it was `fitted` to or one held out.

    A synchronised record is compared line by line; held out, the model's own uncertainty is added to that of the noise,
    r having the covariance I + J P Jᵀ. `noise_covariance` (n_y, n_y), from the record that was fitted, scales the
    residuals of other records. Raises MisuseError for a record of other channels, a model that is unstable along it, or
    a held-out record and a model without covariance.
    """
    found = reproduced(model, record)
    errors = record.output - found.output
    try:
        lines = _Lines.of(model, record, fitted, drop_periods, tolerance)
    except _NotPeriodicError:
        lines = None
    fit = found.best_fit_rate, found.variance_accounted_for
    if lines is None:
        tests = (*noise_tests(errors), *_independence(model, record, errors, fitted))
        omega, residual, scale = _periodogram(errors, record.sample_time, noise_covariance)
        known = noise_covariance is not None
        return VaryingComparison(*fit, known, None, (), np.zeros(0), tests, omega, residual, errors / scale)
    overall, edges = lines.test("lack of fit", np.ones(lines.count, dtype=np.bool_)), lines.edges()
    bands, normalised = lines.bands(edges), lines.normalised()
    return VaryingComparison(
        *fit, True, overall, bands, edges, (), lines.frequencies, normalised, errors / lines.deviation
    )


class _NotPeriodicError(Exception):
    """The record cannot be compared line by line."""


@dataclass(frozen=True, eq=False)
class _Lines:
    """Whitened deviations r (R,) of a synchronised record, ∂r/∂θ, and what the tests need."""

    residuals: PeriodicResiduals
    r: FloatArray
    jacobian: FloatArray
    covariance: FloatArray | None
    leverage: FloatArray
    deviation: FloatArray
    noise_freedom: float
    sample_time: float

    @classmethod
    def of(cls, model: Model, record: VaryingRecord, fitted: bool, drop: int | None, tolerance: float) -> "_Lines":
        try:
            steady = steady_periods(record, drop, tolerance)
            phi = functions_along(model, steady.scheduling)
            residuals = PeriodicResiduals.of(steady, phi, model.structure.order)
        except MisuseError as error:
            raise _NotPeriodicError from error
        if not residuals.blocks.stable(model.theta):
            raise MisuseError("the model is unstable along this scheduling", "model")
        r, jacobian = residuals(model.theta)
        scale, chart = _shrinkage(residuals), residuals.blocks.sizes.chart(model.theta)
        r, jacobian = scale * r, scale[:, None] * (jacobian @ chart)
        if not fitted and model.covariance is None:
            raise MisuseError(
                "the model has no covariance, so that nobody can say how far it may be from data that it was not fitted"
                " to; refine it by maximum likelihood",
                "model",
            )
        covariance = None if fitted else chart.T @ model.theta_covariance @ chart
        leverage = np.sum(orthonormal(jacobian) ** 2, axis=1) if fitted else np.zeros(len(r))
        period, periods = steady.periodicity.period, len(steady.output)
        spans = -(-LEAST_LINES * steady.output.shape[2] // (periods - 1))
        deviation = np.sqrt(np.einsum("fyy->y", residuals.noise.covariance.real) * periods) / period
        return cls(
            residuals,
            r,
            jacobian,
            covariance,
            leverage,
            deviation,
            residuals.noise.degrees_of_freedom / spans,
            record.sample_time,
        )

    @property
    def count(self) -> int:
        """R."""
        return len(self.r)

    def _lines(self) -> FloatArray:
        blocks = self.residuals.blocks
        lines = blocks.lines[self.residuals.used]
        return np.minimum(lines, blocks.period - lines) * 2 * np.pi / (blocks.period * self.sample_time)

    @property
    def frequencies(self) -> FloatArray:
        """ω (F,) rad/s, rising."""
        return np.sort(self._lines())

    def _rows(self, per_line: FloatArray) -> FloatArray:
        """Values of lines (F,) as values of rows (R,)."""
        n_y, real = self.residuals.measured.shape[1], self.residuals.real
        return np.concatenate([np.repeat(per_line, n_y), np.repeat(per_line[~real], n_y)])

    def test(self, name: str, chosen: BoolArray) -> TestResult:
        """Lack of fit of the chosen rows (R,)."""
        r = self.r[chosen]
        energy, freedom = float(r @ r), float(chosen.sum()) - float(self.leverage[chosen].sum())
        if self.covariance is not None:
            values, vectors = np.linalg.eigh(self.covariance)
            root = vectors * np.sqrt(np.maximum(values, 0.0))
            tangents = self.jacobian[chosen] @ root
            gains, directions = np.linalg.eigh(tangents.T @ tangents)
            energy -= float(np.sum((directions.T @ (tangents.T @ r)) ** 2 / (1 + np.maximum(gains, 0.0))))
        return lack_of_fit(name, energy, freedom, float(chosen.sum()) * self.noise_freedom)

    def edges(self) -> FloatArray:
        """Ends of bands of equal ratio over the excited lines."""
        blocks = self.residuals.blocks
        power = np.sum(abs(np.fft.fft(blocks.input, axis=0)) ** 2, axis=1)[blocks.lines[self.residuals.used]]
        omega = self._lines()
        excited = omega[(power > 1e-12 * power.max()) & (omega > 0)]
        if len(excited) < BANDS:
            return np.zeros(0)
        return np.geomspace(excited.min() * (1 - 1e-9), excited.max() * (1 + 1e-9), BANDS + 1)

    def bands(self, edges: FloatArray) -> tuple[TestResult, ...]:
        """Lack of fit in each band."""
        rows = self._rows(self._lines())
        return tuple(
            self.test(f"{low:.4g} … {high:.4g} rad/s", (rows > low) & (rows <= high)) for low, high in pairwise(edges)
        )

    def normalised(self) -> ComplexArray:
        """z (F, n_y), E|z|² = 1, in the order of `frequencies`; white over the outputs."""
        n_y, real = self.residuals.measured.shape[1], self.residuals.real
        r = self.r
        if self.covariance is not None:
            r = r / np.sqrt(1 + np.einsum("rk,kl,rl->r", self.jacobian, self.covariance, self.jacobian))
        first = len(real) * n_y
        z = r[:first].reshape(-1, n_y).astype(np.complex128)
        z[~real] = (z[~real] + 1j * r[first:].reshape(-1, n_y)) / np.sqrt(2)
        return np.asarray(z[np.argsort(self._lines(), kind="stable")])


def _shrinkage(residuals: PeriodicResiduals) -> FloatArray:
    """By what r (R,) is too large on average because its noise covariance is an estimate, as a factor that undoes it.

    E e* Ĉ⁻¹ e = n_y ν/(ν − n_y) for complex e and n_y ν/(ν − n_y − 1) for real e
    """
    nu, n_y, real = residuals.noise.degrees_of_freedom, residuals.measured.shape[1], residuals.real
    of_lines = np.where(real, nu - n_y - 1, nu - n_y) / nu
    return np.asarray(np.sqrt(np.concatenate([np.repeat(of_lines, n_y), np.repeat(of_lines[~real], n_y)])))


def _periodogram(
    errors: FloatArray, sample_time: float, noise: FloatArray | None
) -> tuple[FloatArray, ComplexArray, FloatArray]:
    """ω (F,), the lines of e over their expected deviation for white noise (F, n_y), and the deviation (n_y,)."""
    scale = np.sqrt(np.diag(noise)) if noise is not None else np.sqrt(np.mean(errors**2, axis=0))
    spectrum = np.fft.rfft(errors, axis=0)[1:] / np.sqrt(len(errors))
    omega = 2 * np.pi * np.arange(1, len(spectrum) + 1) / (len(errors) * sample_time)
    scale = np.asarray(np.where(scale > 0, scale, 1.0), dtype=np.float64)
    return np.asarray(omega, dtype=np.float64), np.asarray(spectrum / scale), scale


def _independence(model: Model, record: VaryingRecord, errors: FloatArray, fitted: bool) -> tuple[TestResult, ...]:
    """Whether white errors hold nothing of ψ_i(t − l) u(t − l), l = 0 … K; nothing without covariance of the model.

        z = Πᵀ e Σ_e^{−½},   zᵀ M⁻¹ z ~ χ²(rank M),   M = I − G Gᵀ where fitted, I + T Tᵀ where held out

    Π an orthonormal basis of these products; T what the model's uncertainty adds to z; G what the fit takes away.
    """
    covariance = errors.T @ errors / len(errors)
    if model.covariance is None or not np.all(np.linalg.eigvalsh(covariance) > 0):
        return ()
    whitener = np.linalg.inv(np.linalg.cholesky(covariance)).T
    basis = orthonormal(_delayed_products(record, functions_along(model, record.scheduling)))
    z = (basis.T @ errors @ whitener).ravel()
    changes = np.stack([dy @ whitener for dy in output_changes(model, record.input, record.scheduling)])
    if fitted:
        changes = orthonormal(changes.reshape(len(changes), -1).T).T.reshape(-1, *errors.shape)
    tangents = np.stack([(basis.T @ one).ravel() for one in changes], axis=1)
    values, vectors = np.linalg.eigh((-1 if fitted else 1) * tangents @ tangents.T)
    values = values + 1
    kept = values > LEFT
    statistic = float(np.sum((vectors[:, kept].T @ z) ** 2 / values[kept]))
    return (chi_square("independence of the errors from past input and scheduling", statistic, int(kept.sum())),)


def _delayed_products(record: VaryingRecord, psi: FloatArray) -> FloatArray:
    """ψ_i(t − l) u(t − l) for as many lags as the record has room for, (N, columns)."""
    count = len(record)
    products = (psi[:, :, None] * record.input[:, None, :]).reshape(count, -1)
    lags = max(1, min(LAGS, count // (10 * products.shape[1]), MOST_VALUES // products.size))
    columns = [products]
    for lag in range(1, lags + 1):
        columns.append(np.concatenate([np.zeros((lag, products.shape[1])), products[:-lag]]))
    return np.concatenate(columns, axis=1)
