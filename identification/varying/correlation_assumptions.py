"""Do the data keep the assumptions A1–A3 under which correlation analysis finds sub-Markov parameters?"""

import numpy as np

from identification.arrays import FloatArray
from identification.lti.whiteness import chi_square
from identification.outcome import TestResult

LAGS = 20
BROKEN_BELOW = 1e-3

A1 = "A1: the noise is white"
A1_NORMAL = "A1: the noise is normally distributed"
A2 = "A2: the input is white"
A3 = "A3: the scheduling is white"
A3_INPUT = "A3: the scheduling is independent of the input"

_NOISE = {
    A1: "the noise is not white (A1): its colour is not modelled, and the stated covariance does not hold",
    A1_NORMAL: "the noise is not normally distributed (A1): the estimate is consistent, but no maximum likelihood",
}
_SIGNALS = {
    A2: "the input is not white (A2)",
    A3: "the scheduling is not white (A3)",
    A3_INPUT: "scheduling and input depend on each other (A3)",
}


def signal_tests(psi: FloatArray, inputs: FloatArray) -> tuple[TestResult, ...]:
    """Tests of A2 and A3 [Cox2018] on ψ (N, k), ψ₀ = 1 first, and u (N, n_u).

        Q = N² Σ_{l=1}^{K} ‖r_l‖² / (N−l) ~ χ²(K n²),   r_l the autocorrelation of signals with r_0 = I

    and likewise for the correlation of u and ψ at lags −K … K, each made white first by an autoregression. The
    whiteness of ψ takes in that of its squares, as correlation analysis multiplies samples of ψ. That the ψ_i depend on
    each other at one time is taken account of by the estimator and is no breach. Constant signals are left out.
    """
    scheduling = _orthonormal(np.column_stack([psi[:, 1:], psi[:, 1:] ** 2]))
    linear, u = _orthonormal(psi[:, 1:]), _orthonormal(inputs)
    independence = _independence_test(_innovations(linear), _innovations(u))
    found = [_autocorrelation_test(A2, u), _autocorrelation_test(A3, scheduling), independence]
    return tuple(test for test in found if test is not None)


def noise_tests(errors: FloatArray) -> tuple[TestResult, ...]:
    """Tests of A1 [Cox2018] on what the model leaves of the output, (N, n_y): white, and normally distributed.

    The second is the sum over white combinations of N (S²/6 + E²/24) ~ χ²(2), S skewness and E excess.
    """
    from scipy.stats import kurtosis, skew

    white = _orthonormal(errors)
    found = _autocorrelation_test(A1, white)
    if found is None:
        return ()
    n = len(white)
    skewness, excess = skew(white), kurtosis(white)
    statistic = float(np.sum(n * (skewness**2 / 6 + excess**2 / 24)))
    return (found, chi_square(A1_NORMAL, statistic, 2 * white.shape[1]))


def broken_assumptions(tests: tuple[TestResult, ...], by_correlation: bool) -> tuple[str, ...]:
    """What the data break, in words, for each test with a p-value below 0.001; `by_correlation`: how G was found."""
    signals = (
        ": correlation analysis is biased; use least squares"
        if by_correlation
        else ": the sub-Markov parameters were found by least squares instead of correlation"
    )
    texts = {**_NOISE, **{name: text + signals for name, text in _SIGNALS.items()}}
    return tuple(texts[test.name] for test in tests if test.p_value < BROKEN_BELOW)


def correlation_applies(tests: tuple[TestResult, ...]) -> bool:
    """Whether none of the tests speaks against A2 or A3."""
    return all(test.p_value >= BROKEN_BELOW for test in tests if test.name in (A2, A3, A3_INPUT))


def _orthonormal(signals: FloatArray) -> FloatArray:
    """(N, m) of mean zero and unit covariance with the same span as the centred signals."""
    centred = signals - signals.mean(axis=0)
    size = np.sqrt(np.mean(signals**2, axis=0))
    scale = np.linalg.norm(centred, axis=0)
    varying = scale > 1e-9 * np.maximum(size, np.finfo(float).tiny) * np.sqrt(len(signals))
    u, values, _ = np.linalg.svd(centred[:, varying] / scale[varying], full_matrices=False)
    return np.asarray(u[:, values > 1e-6] * np.sqrt(len(signals)))


def _innovations(signals: FloatArray) -> FloatArray:
    """What an autoregression of order K/2 leaves of the signals (N, m), made orthonormal."""
    order, n = _lags(len(signals)) // 2, len(signals)
    if order == 0 or signals.shape[1] == 0:
        return signals
    past = np.concatenate([signals[order - lag : n - lag] for lag in range(1, order + 1)], axis=1)
    return _orthonormal(signals[order:] - past @ np.linalg.lstsq(past, signals[order:], rcond=1e-10)[0])


def _lags(samples: int) -> int:
    return max(1, min(LAGS, samples // 10))


def _autocorrelation_test(name: str, white: FloatArray) -> TestResult | None:
    n, m = white.shape
    if m == 0:
        return None
    lags = _lags(n)
    terms = [np.sum((white[lag:].T @ white[:-lag] / n) ** 2) / (n - lag) for lag in range(1, lags + 1)]
    return chi_square(name, float(n**2 * np.sum(terms)), lags * m**2)


def _independence_test(one: FloatArray, other: FloatArray) -> TestResult | None:
    n, lags = len(one), _lags(len(one))
    if one.shape[1] == 0 or other.shape[1] == 0:
        return None
    ahead = [np.sum((one[lag:].T @ other[: n - lag] / n) ** 2) / (n - lag) for lag in range(lags + 1)]
    behind = [np.sum((other[lag:].T @ one[: n - lag] / n) ** 2) / (n - lag) for lag in range(1, lags + 1)]
    freedom = (2 * lags + 1) * one.shape[1] * other.shape[1]
    return chi_square(A3_INPUT, float(n**2 * (np.sum(ahead) + np.sum(behind))), freedom)
