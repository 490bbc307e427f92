"""From records and frequency responses to batches of spectra with the variances of their noise."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import EVEN, EXCITED, ODD, Batch
from identification.comparison.between import flattened
from identification.comparison.both_signals import both_signals, excited_in_noise
from identification.comparison.clock import Turned, clock_of, turned
from identification.comparison.disturbance import find_disturbances, without
from identification.comparison.free_record import of_record
from identification.comparison.noise import NoiseOfMean, noise_of_mean
from identification.comparison.scatter import scatter_with_rate
from identification.comparison.wandering import (
    left_in_mean,
    slow_trend,
    steady_count,
    wandering_noise,
    wanders,
    without_trend,
)
from identification.errors import MisuseError
from identification.lti.response_tests import real_lines
from identification.signals import FrequencyResponse, Measurement, TimeRecord
from identification.spectral.periodic_average import PeriodicAverage, excited_lines
from identification.spectral.resolution import check_changing, converter_step, repeated_error

ROUNDS = 0.1
MOST_PARTS = 8
SLOW = "the output drifts slowly over the record; a smooth trend was taken off, and its mean value is not compared"
WALKS = "the level of the output wanders like a random walk; it counts as noise, and the mean value is not compared"
CLAMPED = (
    "the spectrum of the noise is too steep to be told from how the periods differ; its variance was held at a"
    " thousandth of that around it at some lines"
)


def gather(
    experiments: Sequence[Measurement], mean_value: bool = True, logged: Sequence[Mapping[str, float]] = ()
) -> tuple[Batch, ...]:
    """Batches of the experiments, those on the same grid together, in the order in which the grids first occur.

    Periodic records give their mean spectrum at all lines of the period, excited or not, with the variance from how
    the periods differ, pooled over fifteen lines, slow trends and sine waves between the lines taken off; where the
    level of at least half of the records does not stay, that of the others is taken for a walk too small to be seen;
    other records all their lines with an unknown transient, weighted once they are settled under a model
    (`identification.extension.settle`). `mean_value` keeps the line at ω = 0 of periodic records. `logged`: for each
    experiment the quantities written down beside the scheduling variables; those of all are kept.
    """
    if not experiments:
        raise MisuseError("there is nothing to compare with; give at least one experiment", "experiments")
    check_changing(experiments)
    clock = clock_of(experiments)
    parts = [_one(m, data, mean_value, clock) for m, data in enumerate(experiments)]
    unsteady = [any(text in (SLOW, WALKS) for _, text in part.notes) for part in parts]
    if 2 * sum(unsteady) >= sum(part.signals is not None for part in parts) and any(unsteady):
        parts = [
            part if seen or part.signals is None else _one(m, experiments[m], mean_value, clock, wandering=True)
            for m, (part, seen) in enumerate(zip(parts, unsteady, strict=True))
        ]
    if logged:
        parts = _with_logged(parts, logged)
    groups: dict[object, list[Batch]] = {}
    for part in parts:
        groups.setdefault(_grid(part), []).append(part)
    return tuple(_joined(group) for group in groups.values())


def _with_logged(parts: Sequence[Batch], logged: Sequence[Mapping[str, float]]) -> list[Batch]:
    if len(logged) != len(parts):
        raise MisuseError(
            f"there are {len(parts)} experiments and logged quantities of {len(logged)}; give one mapping for each",
            "logged",
        )
    names = sorted(set.intersection(*(set(one) for one in logged)))
    return [
        replace(part, logged={name: np.array([one[name]], dtype=np.float64) for name in names})
        for part, one in zip(parts, logged, strict=True)
    ]


def _grid(part: Batch) -> object:
    kind = (
        part.shape,
        part.decoupling is None,
        part.signals is None,
        part.scaled,
        part.freedom,
        part.raw_freedom,
        part.held,
        part.hold_stated,
        part.smoothed,
        part.repeats,
        type(part.adaptation),
        part.channels.input.quantity,
        part.channels.output.quantity,
        part.averaged,
        part.parts is None,
    )
    return (*kind, part.omega.tobytes())


def _joined(group: list[Batch]) -> Batch:
    first = group[0]
    stacked: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in group])
        for name in ("points", "inputs", "outputs", "variances", "classes", "members")
    }
    stated: dict[str, Any] = {
        name: None if getattr(first, name) is None else np.concatenate([getattr(part, name) for part in group])
        for name in ("signals", "ends", "transients", "begun", "parts", "scatter", "ports", "decoupling")
    }
    nuisances = [part.nuisance for part in group if part.nuisance is not None]
    between = tuple(b for part in group for b in part.between)
    others = [part.adaptation for part in group[1:] if part.adaptation is not None]
    return Batch(
        omega=first.omega,
        sample_time=first.sample_time,
        freedom=first.freedom,
        raw_freedom=first.raw_freedom,
        half_width=first.half_width,
        shape=first.shape,
        coupled=first.coupled,
        nuisance=_padded(nuisances) if nuisances else None,
        slopes=None if first.slopes is None else np.concatenate([p.slopes for p in group if p.slopes is not None]),
        scaled=first.scaled,
        smoothed=first.smoothed,
        held=first.held,
        hold_stated=first.hold_stated,
        between=between,
        disturbances=tuple(one for part in group for one in part.disturbances),
        notes=tuple(one for part in group for one in part.notes),
        logged={name: np.concatenate([part.logged[name] for part in group]) for name in first.logged},
        channels=first.channels,
        adaptation=None if first.adaptation is None else first.adaptation.joined(others),
        averaged=first.averaged,
        drift=float(np.mean([part.drift for part in group])),
        **stated,
        **stacked,
    )


def _padded(signals: Sequence[FloatArray]) -> FloatArray:
    """Arrays (m, n, L) one after another, (M, n, L), rows of zeros where one has fewer."""
    most = max(one.shape[1] for one in signals)
    return np.concatenate([np.pad(one, ((0, 0), (0, most - one.shape[1]), (0, 0))) for one in signals])


def _one(m: int, data: Measurement, mean_value: bool, clock: float, wandering: bool = False) -> Batch:
    if isinstance(data, FrequencyResponse):
        return _of_response(m, data)
    if data.period is None or data.period_count < 2:
        return of_record(m, data)
    return _of_periodic(m, data, mean_value, clock, wandering)


def _of_response(m: int, data: FrequencyResponse) -> Batch:
    """A frequency response without variances is weighted by its own size; the scale of the errors is then not known.

    With several inputs or outputs each path is a row, and the covariance between them is taken out.
    """
    (n_y, n_u), several = data.matrices.shape[1:], data.matrices[0].size > 1
    known = data.variance is not None
    variance = data.variance if data.variance is not None else abs(data.response) ** 2
    freedom = np.inf if data.variance_degrees_of_freedom is None else 2 * data.variance_degrees_of_freedom
    coupled = n_y if data.covariance is not None else 1
    if known and freedom <= 2 * coupled + 2:
        raise MisuseError(
            f"the variances come from {freedom / 2:g} degrees of freedom, too few to weigh with; measure at least"
            " four periods or give the records themselves",
            "experiments",
        )
    if np.any(variance == 0):
        raise MisuseError("a response is zero and has no variance; state the variances", "experiments")
    order = np.argsort(data.frequencies)
    outputs = data.response[order].reshape(len(data), -1).T
    variances = np.asarray(variance[order].reshape(len(data), -1).T, dtype=np.float64)
    rows = len(outputs)
    return Batch(
        points=np.array([data.operating_point] * rows, dtype=np.float64),
        omega=data.frequencies[order],
        inputs=np.ones(outputs.shape, dtype=np.complex128),
        outputs=outputs,
        variances=variances,
        classes=np.full(outputs.shape, EXCITED),
        members=np.full(rows, m),
        ports=np.array([(i, k) for i in range(n_y) for k in range(n_u)]) if several else None,
        shape=(n_y, n_u),
        decoupling=None if data.covariance is None else _decoupling(data.covariance[order], variances.T),
        coupled=coupled,
        sample_time=data.sample_time,
        freedom=freedom,
        raw_freedom=freedom,
        scaled=known,
        held=data.held,
        hold_stated=True,
        channels=data.channels,
    )


def _decoupling(covariance: ComplexArray, variances: FloatArray) -> ComplexArray:
    """D^½ L⁻¹ (1, K, c, c) for C = L Lᴴ (K, c, c) with the diagonal D (K, c)."""
    return np.asarray(np.sqrt(variances)[:, :, None] * np.linalg.inv(np.linalg.cholesky(covariance)))[None]


def _of_periodic(m: int, record: TimeRecord, mean_value: bool, clock: float, wandering: bool) -> Batch:
    period = record.period
    assert period is not None
    drift = turned(record, clock) if clock else Turned(np.zeros(period), np.zeros(len(record)), 0.0)
    record = replace(record, output=record.output - drift.moved)
    trend = slow_trend(record, record.period_count)
    level = record if trend is None else without_trend(record, trend.signal)
    count = steady_count(level, trend is None and wanders(level, record.period_count))
    disturbances = find_disturbances(level, count)
    clean = without(level, disturbances)
    walks = trend is None and (wandering or wanders(clean, count))
    estimator = PeriodicAverage(drop_periods=record.period_count - count)
    u, y = (spectra / period for spectra in estimator.steady_spectra(clean))
    omega = np.asarray(2 * np.pi * np.fft.rfftfreq(period, record.sample_time), dtype=np.float64)
    real = real_lines(omega, record.sample_time)
    excited = excited_lines(u, estimator.threshold) & excited_in_noise(u, real)
    back = drift.turned_back(y, record.period_count - count) if clock else y
    noise = _noise(u, back, excited, real, walks)
    step = converter_step(record.output)
    rounding = repeated_error(step, float(np.sqrt(np.sum(np.var(y, axis=0, ddof=1) * np.where(real, 1, 2)))))
    rounded = np.asarray(rounding / period * np.where(real, 2.0, 1.0))
    both = both_signals(u, y, excited, rounded, record.feedback, walks)
    variances = noise.variance + rounded
    if not mean_value or trend is not None:
        variances[0] = np.inf
    shown = y + np.fft.rfft(drift.moved[: record.period_count * period].reshape(-1, period))[-count:] / period
    mean_input = u.mean(axis=0) if both else np.where(excited, u.mean(axis=0), 0.0)
    return Batch(
        points=np.array([record.operating_point], dtype=np.float64),
        omega=omega,
        inputs=mean_input[None],
        outputs=shown.mean(axis=0)[None],
        variances=variances[None],
        classes=_classes(excited)[None],
        members=np.array([m]),
        signals=np.fft.irfft(mean_input * period, n=period)[None],
        sample_time=record.sample_time,
        held=record.held,
        hold_stated=record.hold is not None,
        freedom=noise.freedom,
        raw_freedom=2.0 * (count - 1),
        half_width=noise.half_width,
        ends=noise.ends[None],
        nuisance=left_in_mean(period, 0 if trend is None else trend.degree, count, walks)[None],
        slopes=_slopes(np.where(excited, y - _between(u, y, excited) * u, y))[None],
        drift=drift.skew,
        scatter=_scatter(y, noise.variance, record, step)[None],
        between=(between_harmonics(level, count),),
        disturbances=(disturbances,),
        channels=record.channels,
        notes=(
            *_notes(m, noise, step if rounding > ROUNDS * float(np.median(noise.variance)) * period else 0.0),
            *([(m, SLOW)] if trend is not None else [(m, WALKS)] if walks else []),
        ),
        adaptation=both,
        begun=np.array([(record.period_count - count) * period * record.sample_time]),
        averaged=count,
        parts=_parts(shown)[None] if clock and both is None else None,
    )


def _scatter(y: ComplexArray, noise: FloatArray, record: TimeRecord, step: float) -> FloatArray:
    """`scatter_with_rate`; nothing is said of a period of an odd number of samples, nor where a converter rounds,

    which flickers between two values the more often the slower the output changes.
    """
    assert record.period is not None
    even = step == 0 and record.period % 2 == 0 and bool(np.all(np.isfinite(noise[1:])))
    return scatter_with_rate(y, noise, record.sample_time) if even else np.array([0.0, np.inf])


def _parts(spectra: ComplexArray) -> ComplexArray:
    """The spectra (P, K) of periods; of many the last ones as means of neighbours, `MOST_PARTS` of them."""
    count = min(len(spectra), MOST_PARTS)
    last = spectra[len(spectra) % count :]
    return np.asarray(last.reshape(count, -1, spectra.shape[1]).mean(axis=1))


def _slopes(spectra: ComplexArray) -> ComplexArray:
    """Σ c_p Y_p of spectra (P, K), c_p ∝ p − (P + 1)/2 and Σ c_p² = 1/P."""
    place = np.arange(len(spectra)) - (len(spectra) - 1) / 2
    return np.asarray(place / np.sqrt(len(spectra) * np.sum(place**2)) @ spectra)


def _notes(m: int, noise: NoiseOfMean, step: float) -> tuple[tuple[int, str], ...]:
    coarse = (
        f"the output stands on a grid of {step:.3g}; its rounding repeats with the period, so that the periods do not"
        " show it: it was added to the noise"
    )
    texts = [CLAMPED] * (noise.clamped > 0) + [coarse] * (step > 0)
    return tuple((m, text) for text in texts)


def _noise(u: ComplexArray, y: ComplexArray, excited: BoolArray, real: BoolArray, walks: bool) -> NoiseOfMean:
    """Of the mean of E = Y − Ĝ U at excited lines, with Ĝ between them on straight lines, and of Y at the others.

    Where the input was measured with noise, that of E is the same kind at neighbouring lines only when Ĝ U is taken off
    all of them; pooled with lines at which nothing is taken off it would be judged too quiet.
    """
    of = wandering_noise if walks else noise_of_mean
    smallest = 1e-26 * float(np.mean(abs(y) ** 2)) + float(np.finfo(np.float64).tiny)
    found = of(y - _between(u, y, excited) * u, real)
    if np.any(np.ptp(abs(u - u.mean(axis=0)), axis=0) > 1e-12 * abs(u).max()) and not excited.all():
        found = replace(found, variance=np.where(excited, found.variance, of(y, real).variance))
    return replace(found, variance=np.maximum(found.variance, smallest))


def _between(u: ComplexArray, y: ComplexArray, excited: BoolArray) -> ComplexArray:
    """Ĝ (K,): Ȳ/Ū at the excited lines, and on straight lines between them."""
    lines = np.flatnonzero(excited)
    if not len(lines):
        return np.zeros(len(excited), dtype=np.complex128)
    ratio = y.mean(axis=0)[lines] / u.mean(axis=0)[lines]
    every = np.arange(len(excited))
    return np.asarray(np.interp(every, lines, ratio.real) + 1j * np.interp(every, lines, ratio.imag))


def _classes(excited: BoolArray) -> IntArray:
    parity = np.where(np.arange(len(excited)) % 2 == 1, ODD, EVEN)
    return np.where(excited, EXCITED, parity)


def between_harmonics(record: TimeRecord, count: int) -> FloatArray:
    """Power of the output between the harmonics, (lines,): what does not repeat, where it wanders its differences.

    The last `count` periods are transformed together; of every `count` lines the one that is a harmonic is left out.
    """
    assert record.period is not None
    first = (record.period_count - count) * record.period
    signal = record.output[first : first + count * record.period]
    lines = abs(np.fft.rfft(signal) / len(signal)) ** 2
    free = np.flatnonzero(np.arange(len(lines)) % count)
    return flattened(np.asarray(lines[free], dtype=np.float64), free.astype(np.float64), len(signal))
