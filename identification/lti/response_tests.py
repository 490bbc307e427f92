"""What the residuals of a model of a frequency response say: noise, lack of fit, whiteness over frequency."""

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.outcome import TestResult
from identification.signals import FrequencyResponse


def real_lines(frequencies: FloatArray, sample_time: float | None) -> BoolArray:
    """Which lines (F,) lie at ω = 0 or at the Nyquist frequency, where a response is real and so is its noise.

    The noise is not circular there. The variance stated at such a line is twice that of the real number, so that
    half of it is the variance of the real part as everywhere else; the imaginary part holds no information.
    """
    at_zero = frequencies == 0
    if sample_time is None:
        return np.asarray(at_zero)
    return np.asarray(at_zero | (abs(frequencies * sample_time / np.pi - 1) < 1e-9))


def real_count(data: FrequencyResponse) -> int:
    """How many real numbers a frequency response holds: two a line, one where the response is real."""
    return 2 * len(data) - int(np.sum(real_lines(data.frequencies, data.sample_time)))


def variance_inflation(degrees_of_freedom: float | None) -> float:
    """By how much a covariance (JᵀJ)⁻¹ computed with estimated variances has to grow; 1 for known variances.

        P = d/(d − 2) (Jᵀ J)⁻¹,   σ̂² ~ σ² χ²_{2d}/2d independent of Ĝ

    One factor (d − 1)/(d − 2) is the efficiency lost to random weights, d/(d − 1) the optimism of E σ̂⁻²
    [PintelonSchoukens2012, Section 12.3]. Raises MisuseError for d ≤ 2, where weights have no second moment.
    """
    if degrees_of_freedom is None:
        return 1.0
    if degrees_of_freedom <= 2:
        raise MisuseError(
            f"the variances come from {degrees_of_freedom:g} degrees of freedom, too few to weight with; measure at"
            " least four periods or use the weighting 'relative' or 'absolute'",
            "weighting",
        )
    return degrees_of_freedom / (degrees_of_freedom - 2)


def gaussian_errors(data: FrequencyResponse, errors: ComplexArray) -> ComplexArray:
    """Errors (F,) with E|e|² = 1 turned from Student's to Gaussian distribution where their variance was estimated.

        |ẽ|² = d ln(1 + |e|²/d),   which is exponential with mean 1 when |e|² ~ F(2, 2d)

    At real lines |e|² = x²/2 with x of Student's distribution with d degrees of freedom is mapped by probabilities.
    """
    d = data.variance_degrees_of_freedom
    if data.variance is None or d is None:
        return errors
    power = abs(errors) ** 2
    gaussian = d * np.log1p(power / d)
    real = real_lines(data.frequencies, data.sample_time)
    gaussian[real] = chdtri(1, fdtrc(1, d, 2 * power[real])) / 2
    return np.asarray(errors * np.sqrt(np.divide(gaussian, power, out=np.ones_like(power), where=power > 0)))


def lack_of_fit(data: FrequencyResponse, errors: ComplexArray, parameters: int) -> TestResult:
    """χ² test of errors (F,) whitened with a stated variance: 2 Σ|ẽ_k|² ~ χ² with as many real numbers − n."""
    free = real_count(data) - parameters
    statistic = 2 * float(np.sum(abs(gaussian_errors(data, errors)) ** 2))
    return TestResult("lack of fit", statistic, free, float(chdtrc(free, statistic)))


def neighbour_correlation(
    data: FrequencyResponse, errors: ComplexArray, jacobian: FloatArray, whitening: FloatArray
) -> TestResult:
    """χ² test with one degree of freedom of the correlation between errors of neighbouring frequencies.

        S = Σ Re(e_k* e_{k+1}) = eᵀ L e,   E S = s² tr(MᵀLM),   var S = 2 s⁴ tr((MᵀLM)²),   e = M n

    `errors` (F,) and `jacobian` (2F, n) are those minimised; times `whitening` (F,) the errors have alike noise n.
    M = I − A Bᵀ is what the fit leaves of the noise, s² the mean square of what is left.
    """
    order = np.argsort(data.frequencies)
    gaussian = gaussian_errors(data, errors * whitening)[order]
    residual = np.concatenate([gaussian.real, gaussian.imag])
    span, values, _ = np.linalg.svd(jacobian / _lengths(jacobian), full_matrices=False)
    span = span[np.concatenate([order, len(order) + order])][:, values > 1e-12 * values.max(initial=1e-300)]
    whiten = np.tile(whitening[order], 2)[:, None]
    free, mean, spread = _moments(span * whiten, span / whiten, real_count(data))
    scale = float(residual @ residual) / max(free, 1e-300)
    if free < 1.5 or spread <= 1e-9 or scale == 0:
        return TestResult("whiteness over frequency", 0.0, 1.0, 1.0)
    standard = (residual @ _neighbours(residual[:, None])[:, 0] / scale - mean) / np.sqrt(2 * spread)
    return TestResult("whiteness over frequency", float(standard**2), 1.0, float(chdtrc(1, standard**2)))


def _moments(a: FloatArray, b: FloatArray, count: int) -> tuple[float, float, float]:
    """tr(MᵀM), tr(MᵀLM) and tr((MᵀLM)²) for M = I − A Bᵀ, A and B (2F, n), without forming it."""
    moved, n = _neighbours(a), a.shape[1]
    between = a.T @ moved
    core = np.block([[np.zeros((n, n)), -np.eye(n)], [-np.eye(n), between]])
    low_rank = np.concatenate([moved, b], axis=1)
    free = count - 2 * np.sum(a * b) + np.sum((a.T @ a) * (b.T @ b))
    mean = -2 * np.sum(moved * b) + np.sum(between * (b.T @ b))
    inner = core @ (low_rank.T @ low_rank)
    spread = len(a) / 2 - 1 + 2 * np.sum(core * (low_rank.T @ _neighbours(low_rank))) + np.sum(inner * inner.T)
    return float(free), float(mean), float(spread)


def _lengths(jacobian: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(jacobian, axis=0)
    return np.where(lengths > 0, lengths, 1.0)


def _neighbours(columns: FloatArray) -> FloatArray:
    """L v for v (2F, m): half the sum of the values on the lines next to each, separately for both parts."""
    parts = columns.reshape(2, -1, columns.shape[1])
    result = np.zeros_like(parts)
    result[:, 1:] += parts[:, :-1] / 2
    result[:, :-1] += parts[:, 1:] / 2
    return result.reshape(columns.shape)
