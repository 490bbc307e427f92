"""A design to begin with: what the data and the model say about band, sample time, levels and accuracy."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.conversion.designs import prior_information
from app.schemas.experiments import Experiment
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import Plant
from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.models.model import Model

RELATIVE_DEVIATION = 0.01 / 1.96
IMPROVED = 0.5
POINTS, TARGETS, CANDIDATES = (17, 7, 4), (9, 4, 3), (5, 3, 2)
SAMPLES = 1000
LONGEST_PERIOD, SHORTEST_PERIOD = 4096, 64
PERIODS = 1000
LEVELS = 3
FREQUENCIES = 20


@dataclass(frozen=True)
class Seen:
    """What the experiments of a model were like: band in rad/s, sample time, samples, period, levels of the input.

    `measured`: the band is that of the data, in which the model is known.
    """

    low: float
    high: float
    step: float
    samples: int
    period: int
    levels: tuple[float, ...]
    measured: bool


def usual_design(document: ModelDocument, plant: Plant, model: Model, seen: Seen) -> dict[str, Any]:
    """A request for the design that a model suggests, as JSON: its frequency response over the range, in the band seen.

    To ± 1 % with 95 % probability, or to half the deviation that it has where that is less; what the model knows is
    counted. Where an effect acts on signals, multisines of the levels seen are chosen from, else line spectra.
    """
    signals = any(one.effect.needs_records for one in model.effects)
    variables = plant.scheduling_variables
    number = min(len(variables), len(POINTS)) - 1
    spans = [(one.minimum, one.maximum) for one in variables]
    counts = CANDIDATES[number] if signals else POINTS[number]
    known = _known(document, model)
    where = _spread(spans, TARGETS[number])
    deviation = _deviation(model, where, seen, known)
    relative = bool(np.all(_size(model, where, seen) > 0))
    multisines = {"kind": "multisines", "samples": seen.period, "levels": list(seen.levels)}
    lines = {"kind": "lines", "samples": seen.period}
    target = {
        "kind": "response_deviation",
        "operatingPoints": where.tolist(),
        "minimumRadPerSecond": seen.low,
        "maximumRadPerSecond": seen.high,
        "standardDeviation": deviation,
        "relative": relative,
        "count": FREQUENCIES,
    }
    return {
        "plantId": plant.id,
        "modelId": document.id,
        "operatingPoints": {
            "kind": "gridAxes",
            "axes": [{"minimum": low, "maximum": high, "count": counts if high > low else 1} for low, high in spans],
        },
        "targets": [target],
        "spectrumFamily": multisines if signals else lines,
        "samples": PERIODS * seen.period if signals else max(seen.samples, seen.period),
        "sampleTimeSeconds": None if model.structure.is_discrete else seen.step,
        "band": {"minimumRadPerSecond": seen.low, "maximumRadPerSecond": seen.high} if seen.measured else None,
        "usePriorInformation": known,
    }


def seen_in(model: Model, experiments: Sequence[Experiment], levels: Sequence[float]) -> Seen:
    """What was seen in experiments; what they leave open is taken from the model. `levels`: rms of their inputs."""
    known = [one.understood for one in experiments]
    steps = [one.sample_time_seconds for one in experiments if one.sample_time_seconds]
    lows = [one.minimum_frequency_rad_per_second for one in known if one.minimum_frequency_rad_per_second]
    highs = [one.maximum_frequency_rad_per_second for one in known if one.maximum_frequency_rad_per_second]
    own = model.structure.sample_time
    middle = 0.1 * np.pi / own if own else model.structure.frequency_scale
    high = float(np.median(highs)) if highs else 3 * middle
    step = own or (float(np.median(steps)) if steps else 0.25 * np.pi / high)
    high = min(high, 0.9 * np.pi / step)
    low = min(float(np.median(lows)) if lows else middle / 5, high / 2)
    periods = [one.period_samples for one in known if one.period_samples]
    wanted = int(np.clip(2 ** np.ceil(np.log2(2 * np.pi / (low * step))), SHORTEST_PERIOD, LONGEST_PERIOD))
    period = int(np.median(periods)) if periods else wanted
    low = min(max(low, 2 * np.pi / (period * step)), high)
    samples = max((one.samples for one in known if one.samples), default=SAMPLES)
    return Seen(low, high, step, samples, max(period, SHORTEST_PERIOD // 8), _distinct(levels), bool(highs))


def _distinct(levels: Sequence[float]) -> tuple[float, ...]:
    """At most three levels over the range of those seen, one when they are alike; one where nothing was seen."""
    positive = [level for level in levels if np.isfinite(level) and level > 0]
    if not positive:
        return (1.0,)
    low, high = min(positive), max(positive)
    count = LEVELS if high > 1.1 * low else 1
    return tuple(float(f"{level:.4g}") for level in np.geomspace(low, high, count))


def _known(document: ModelDocument, model: Model) -> bool:
    try:
        prior_information(model, document.covariance is not None)
    except MisuseError:
        return False
    return True


def _deviation(model: Model, where: FloatArray, seen: Seen, known: bool) -> float:
    """The standard deviation to ask for: of |G|, or in its unit where G has a zero."""
    size = _size(model, where, seen)
    scale = size if np.all(size > 0) else np.full(size.shape, max(float(size.max()), np.finfo(float).tiny))
    ratio = 1.0 if np.all(size > 0) else float(scale.flat[0])
    if not known:
        return RELATIVE_DEVIATION * ratio
    worst = float(np.sqrt(np.max(np.linalg.eigvalsh(_covariance(model, where, seen))[..., -1] / scale**2)))
    reached = float(f"{IMPROVED * worst:.2g}") if np.isfinite(worst) and worst > 0 else RELATIVE_DEVIATION
    return min(RELATIVE_DEVIATION, reached) * ratio


def _covariance(model: Model, where: FloatArray, seen: Seen) -> FloatArray:
    """Of Re G and Im G of the plant, its effects being estimated with it, (M, F, 2, 2)."""
    joint = model.joint_covariance if model.effects else model.plant_covariance
    assert joint is not None, "what is known has a covariance"
    gradient = model.structure.plant_gradient(model.coefficients(where), _frequencies(seen))
    by_theta = model.pulled(np.swapaxes(gradient, 1, 2), where)
    parts = np.stack([by_theta.real, by_theta.imag], axis=-2)
    plant = joint[: model.plant_size, : model.plant_size]
    return np.asarray(parts @ plant @ np.swapaxes(parts, -1, -2))


def _size(model: Model, where: FloatArray, seen: Seen) -> FloatArray:
    return np.asarray(abs(model.frequency_response(where, _frequencies(seen))[..., 0, 0]))


def _frequencies(seen: Seen) -> FloatArray:
    return np.geomspace(seen.low, seen.high, FREQUENCIES)


def _spread(spans: Sequence[tuple[float, float]], count: int) -> FloatArray:
    axes = [np.linspace(low, high, count if high > low else 1) for low, high in spans]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(spans))
