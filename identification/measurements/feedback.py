"""Whether a controller acted on the output while a record was made: does the output foretell the input?"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular

from identification.arrays import FloatArray
from identification.lti.likelihood import delayed as delayed_by
from identification.lti.whiteness import chi_square, orthonormal
from identification.outcome import TestResult
from identification.signals import TimeRecord

ORDERS = (2, 4, 8, 16, 32)
AHEAD = 16
LONGEST = 16384
LEVEL = 1e-3
VARIES, FORESEEN = 1e-10, 1e-3
EACH, ROUNDING = 6, 1e-9
TAIL, POWERS = 256, 4
OWN, MOVING = 4, 8
NAME = "feedback from output to input"
FOUND = (
    "The input follows what disturbed the output before (p = {:.1g}): a controller seems to have acted. State feedback,"
    " and the reference if it was recorded."
)
REPEATS = (
    "A controller acted, but the input is the same in every period: this seems to be what was asked of the loop and not"
    " what reached the plant. Record the input of the plant, and give this as the reference."
)


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Input and output (N,) of one stretch without a gap, and what of the input is news."""

    u: FloatArray
    y: FloatArray
    news: FloatArray


def feedback_test(record: TimeRecord, delayed: bool = False) -> TestResult | None:
    """Test of no feedback: in open loop the inputs that are still to come say nothing about the output.

        y(t) = Σ_{1≤i≤n} a_i y(t − i) + Σ_{d≤i≤n} b_i u(t − i) + Σ_{−d<j≤m} c_j w(t + j) + e(t),   c = 0
        S = gᵀ V⁻¹ g ~ χ²(rank),   g = Z̃ᵀ e,   V = Σ e(t)² z̃(t) z̃(t)ᵀ

    [Sims1972; GewekeMeeseDent1983]. e are the residuals without c, Z̃ what the news w of the future input have beyond
    the regressors; c ≠ 0 where past disturbances help to predict the input beyond its own past. w is what an
    autoregression whose coefficients move slowly does not foretell: of a sweep nothing. The input may be any, the
    noise coloured (n is that of least AIC), of changing size [White1980]. d is one where the plant is known to answer
    with a delay (`delayed`), else zero, as a controller within the sample cannot be told from a plant within it. Where
    the input is not held, a sampled plant answers before its input by what lies between the samples, which falls off
    as (−1)^j/j, …, (−1)^j/j⁴; that counts among the regressors. What repeats with the period of a periodic
    record is taken out first, by contrasts of its periods, so that neither nonlinearity nor the shape of the input
    matter; where present and past of the input then leave nothing of the output, the present one counts as a
    controller's. None where the input repeats exactly, is foretold by its own past, or the record is too short: then
    there was no feedback of noise, or none that can be seen.
    """
    stretches = _stretches(record)
    samples = sum(len(one.u) for one in stretches)
    orders = [n for n in ORDERS if samples >= EACH * (3 * n + AHEAD) and min(len(s.u) for s in stretches) > 4 * n]
    if not orders or not any(_varies(one.news) for one in stretches):
        return None
    largest = orders[-1]
    first, held = int(delayed), record.hold in ("zero", "first")

    def regression(n: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        return _regression(stretches, _Lags(n, largest, first, held))

    order = min(orders, key=lambda n: _criterion(*regression(n)[:2]))
    columns, target, ahead = regression(order)
    q = orthonormal(columns)
    errors = target - q @ (q.T @ target)
    left = ahead - q @ (q.T @ ahead)
    size = np.linalg.norm(ahead, axis=0)
    kept = np.linalg.norm(left, axis=0) > FORESEEN * np.where(size > 0, size, np.inf)
    basis = orthonormal(left[:, kept]) if kept.any() else left[:, :0]
    if basis.shape[1] == 0:
        return None
    if not np.linalg.norm(errors) > ROUNDING * np.linalg.norm(target):
        return None if delayed or len(stretches) == 1 else feedback_test(record, delayed=True)
    return _score(basis, errors)


def feedback_seen(record: TimeRecord, delayed: bool = False) -> TestResult | None:
    """The test where it speaks for feedback at a level of 1 in 1000 and feedback was not stated; None otherwise."""
    found = None if record.feedback else feedback_test(record, delayed)
    return found if found is not None and found.p_value < LEVEL else None


def feedback_warnings(record: TimeRecord) -> tuple[str, ...]:
    """What is to be said of a record whose statement about feedback does not agree with its signals."""
    found = feedback_seen(record)
    said = () if found is None else (FOUND.format(max(found.p_value, 1e-99)),)
    return (*said, *([REPEATS] if record.feedback and repeats_exactly(record) else []))


def repeats_exactly(record: TimeRecord) -> bool:
    """Whether the input of a periodic record is the same in every period: a controller of its output moved it not."""
    return record.period is not None and record.period_count > 1 and not any(_varies(s.u) for s in _stretches(record))


def _score(basis: FloatArray, errors: FloatArray) -> TestResult:
    gradient = basis.T @ errors
    factor = np.linalg.qr(basis * errors[:, None], mode="r")
    if np.any(abs(np.diag(factor)) <= 1e-12 * np.linalg.norm(errors)):
        return chi_square(NAME, 0.0, basis.shape[1])
    scaled = solve_triangular(factor, gradient, trans="T")
    return chi_square(NAME, float(scaled @ scaled), basis.shape[1])


def _stretches(record: TimeRecord) -> list[_Stretch]:
    """The record, or its periods as P − 1 contrasts with no mean (Helmert's), each with unit gain on white noise."""
    u, y, period = record.input, record.output, record.period
    if period is None or record.period_count < 2:
        return [_stretch(u[-LONGEST:], y[-LONGEST:])]
    count = record.period_count
    blocks = [x[: count * period].reshape(count, period) for x in (u, y)]
    place = np.arange(1, count)
    contrasts = np.tri(count - 1, count) - np.eye(count - 1, count, 1) * place[:, None]
    contrasts /= np.sqrt(place * (place + 1))[:, None]
    most = max(LONGEST // period, 1)
    level = abs(u).max()
    of_u, of_y = (contrasts[-most:] @ block for block in blocks)
    of_u = np.where(abs(of_u) > VARIES * level, of_u, 0.0)
    return [_Stretch(*pair, pair[0]) for pair in zip(of_u, of_y, strict=True)]


def _stretch(u: FloatArray, y: FloatArray) -> _Stretch:
    """With the news of the input: none where it is foretold to a thousandth."""
    about, time = u - u.mean(), np.linspace(-1, 1, len(u))
    degree = min(MOVING, len(u) // 50)
    slow = np.polynomial.legendre.legvander(time, degree)
    columns = (delayed_by(about, 1, OWN)[:, :, None] * slow[:, None, :]).reshape(len(u), -1)
    q = orthonormal(columns[OWN:])
    left = about[OWN:] - q @ (q.T @ about[OWN:])
    news = np.concatenate([np.zeros(OWN), left])
    return _Stretch(u, y, news if np.linalg.norm(left) > FORESEEN * np.linalg.norm(about) else np.zeros(len(u)))


def _varies(u: FloatArray) -> bool:
    return bool(np.ptp(u) > 0)


@dataclass(frozen=True)
class _Lags:
    """Order n, the largest of all that are tried, the first lag d of the plant, whether the input is held."""

    order: int
    largest: int
    first: int
    held: bool


def _regression(stretches: list[_Stretch], lags: _Lags) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Regressors (R, c), outputs (R,) and inputs that are tested (R, m + d) of the same samples whatever the order."""
    parts = []
    for one in stretches:
        used = slice(lags.largest, len(one.u) - AHEAD)
        line = np.linspace(-1, 1, len(one.u))
        before = delayed_by(one.u, lags.first, lags.order + 1 - lags.first)
        past = [delayed_by(one.y, 1, lags.order), before, np.stack([np.ones_like(line), line], axis=1)]
        past += [] if lags.held else [_between_samples(one.u)]
        ahead = np.stack([np.roll(one.news, -j) for j in range(1 - lags.first, AHEAD + 1)], axis=1)
        parts.append((np.concatenate(past, axis=1)[used], one.y[used], ahead[used]))
    columns, target, ahead = (np.concatenate(each) for each in zip(*parts, strict=True))
    return columns, target, ahead


def _between_samples(u: FloatArray) -> FloatArray:
    """Σ_j (−1)^j/j^k u(t ± j), k = 1 … 4, (N, 8)."""
    j = np.arange(1, min(TAIL, len(u)) + 1)
    kernels = (-1.0) ** j / j ** np.arange(1, POWERS + 1)[:, None]
    padded = np.fft.rfft(u, 2 * len(u))
    found = []
    for kernel in kernels:
        lines = np.fft.rfft(np.concatenate([[0.0], kernel]), 2 * len(u))
        found += [np.fft.irfft(padded * part, 2 * len(u))[: len(u)] for part in (lines, lines.conj())]
    return np.stack(found, axis=1)


def _criterion(columns: FloatArray, target: FloatArray) -> float:
    """Akaike's."""
    q = orthonormal(columns)
    left = max(float(target @ target - np.sum((q.T @ target) ** 2)), np.finfo(float).tiny)
    return float(len(target) * np.log(left) + 2 * q.shape[1])
