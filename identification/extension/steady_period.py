"""One period of the steady output of a model with effects, for a periodic input at operating points held still."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray, finite_floats, require_positive
from identification.comparison.batch import EXCITED, Batch
from identification.confidence import covariance_root
from identification.effects.second_variable import SecondVariable
from identification.errors import MisuseError, RangeError, ShapeError
from identification.extension.response import with_only
from identification.models.model import Model, require_matching
from identification.places.linear import Factor, Parallel
from identification.places.nonlinear import Added
from identification.places.place import Effect, Flow
from identification.places.placed import PlacedEffect
from identification.places.steady import NoSteadyStateError
from identification.signals import HeldInput, Hold

FINER = 4
STEP = 0.1
ROUNDING, NEGLIGIBLE = 1e-14, 1e-9
OF_MEASUREMENTS = "it belongs to single measurements, not to the plant"
OF_PERIOD = "it is a disturbance in step with the period in which it was found, not an answer to the input"


@dataclass(frozen=True)
class LeftOut:
    """An effect of a model that a simulation does not hold, and why."""

    effect: Effect
    reason: str


@dataclass(frozen=True, eq=False)
class SteadyPeriod:
    """The output (M, L) at the samples of the input, and its standard deviation (M, L).

    `deviation`: by the joint covariance of all parameters; None where that is not known, or where parameters a tenth
    of a deviation away have no steady state.
    """

    output: FloatArray
    deviation: FloatArray | None
    left_out: tuple[LeftOut, ...]


def steady_period(
    model: Model,
    input: ArrayLike,
    sample_time: float,
    points: ArrayLike,
    logged: Mapping[str, float] | None = None,
    covariance_known: bool = True,
    hold: Hold = "band",
) -> SteadyPeriod:
    """What the model shows once it has settled, at the operating points (M, s), for one period u (L,) of the input.

        u → g(u) → [ X = G(p) (U − F{f(x, ẋ)}) ] → + modes → · factor, + parallel → h(y),    x(t) = Σ_k X_k e^{jω_k t}
        var y(t) = Σ_i (y(t; β + h r_i) − y(t; β − h r_i))²/(2h)²,   Σ_i r_i r_iᵀ = cov β,   h = 0.1

    β are the parameters of plant and effects; without effects their covariance is P_θ. Discrete time is exact on the
    samples; in continuous time u is the sum of its lines between them, and what forces and sensors add is followed up
    to four times the Nyquist frequency; where `hold` says that u is held, up to that frequency. `logged`: values of the
    quantities that the model depends on beside p. Effects of single measurements and disturbances over a period are
    left out. Where there are several steady states it is one of them, as a rule the one next to that of the linear
    plant.

    Raises NoSteadyStateError, naming the operating point, where there is none: the plant is unstable there, or an
    effect too strong; ShapeError, RangeError and MisuseError for input, points, sampling or quantities that do not fit.
    """
    kept, left_out = _held(model, logged or {}, covariance_known)
    p = kept.dependence.points(points)
    outputs, deviations = [], []
    for point in p:
        batch = batch_of_period(kept, input, sample_time, point, logged or {}, hold)
        flow = _settled(kept, batch, point)
        outputs.append(_samples(batch, flow.output, np.size(input)))
        deviations.append(None if kept.joint_covariance is None else _deviation(kept, batch, flow, len(outputs[-1])))
    known = [one for one in deviations if one is not None]
    return SteadyPeriod(np.array(outputs), np.array(known) if len(known) == len(outputs) else None, left_out)


def record_from_rest(
    model: Model,
    input: ArrayLike,
    sample_time: float,
    point: ArrayLike,
    logged: Mapping[str, float] | None = None,
    hold: Hold = "band",
) -> FloatArray:
    """The output (N,) from rest at one operating point (s,) for an input u (N,) that does not repeat.

    As many zeros follow it as it has samples, in which what acts linearly must settle; forces that effects feed back
    are followed in time, whether or not their motion would repeat. Otherwise as `steady_period`, whose errors it
    raises.
    """
    u = finite_floats(input, "input")
    kept, _ = _held(model, logged or {}, False)
    p = kept.dependence.points(np.atleast_2d(point))[0]
    batch = batch_of_period(kept, np.concatenate([u, np.zeros(len(u))]), sample_time, p, logged or {}, hold)
    flow = kept.from_rest(batch)
    where = f"at the operating point ({', '.join(f'{value:g}' for value in p)})"
    _require_stable(kept, flow, where)
    return _samples(batch, flow.output, 2 * len(u))[: len(u)]


def batch_of_period(
    model: Model,
    input: ArrayLike,
    sample_time: float,
    point: FloatArray,
    logged: Mapping[str, float],
    hold: Hold = "band",
) -> Batch:
    """A measurement of nothing at one operating point (s,), with u (L,) as its input over one period.

    U = rfft(u)/L at ω_k = 2πk/(L T); in continuous time, unless u is held, on a grid of samples that is four times as
    fine, the lines beyond L/2 being zero. Raises ShapeError, RangeError, and MisuseError for another sampling than
    the model's.
    """
    u = finite_floats(input, "input")
    if u.ndim != 1 or len(u) < 2:
        raise ShapeError(f"the input has shape {u.shape}; give one period of two samples or more", "input")
    require_positive(sample_time, "sample time")
    held = HeldInput(sample_time, hold) if hold != "band" else None
    finer = 1 if model.structure.is_discrete or held else FINER
    lines = np.fft.rfft(u) / len(u)
    lines[abs(lines) <= ROUNDING * abs(lines).max()] = 0.0
    if finer > 1 and len(u) % 2 == 0:
        lines[-1] /= 2
    length = finer * len(u)
    spectrum = np.zeros((1, length // 2 + 1), dtype=np.complex128)
    spectrum[0, : len(lines)] = lines
    batch = Batch(
        points=np.atleast_2d(point),
        omega=np.asarray(2 * np.pi * np.fft.rfftfreq(length, sample_time / finer)),
        inputs=spectrum,
        outputs=np.zeros_like(spectrum),
        variances=np.ones(spectrum.shape),
        classes=np.full(spectrum.shape, EXCITED),
        members=np.zeros(1, dtype=np.int64),
        signals=np.fft.irfft(spectrum * length, n=length),
        sample_time=sample_time / finer,
        logged={name: np.array([value], dtype=np.float64) for name, value in logged.items()},
        held=held,
        hold_stated=True,
    )
    require_matching(model, (batch,))
    return batch


def _samples(batch: Batch, spectra: ComplexArray, count: int) -> FloatArray:
    """A signal with lines (1, K) at the samples of the input, (L,)."""
    signal = batch.signal(spectra)[0]
    return np.asarray(signal[:: len(signal) // count])


def _held(model: Model, logged: Mapping[str, float], covariance_known: bool) -> tuple[Model, tuple[LeftOut, ...]]:
    """The model without the effects that are left out, with the covariance of its parameters where that is known."""
    reasons = [_why_left_out(one.effect) for one in model.effects]
    quantities = {one.effect.quantity for one in model.effects if isinstance(one.effect, SecondVariable)} - {""}
    missing = sorted(quantities - set(logged))
    if missing:
        raise MisuseError(f"the model depends on {', '.join(missing)}; state the value of each", "logged")
    known = replace(model, joint_covariance=model.known_covariance if covariance_known else None)
    left_out = tuple(LeftOut(one.effect, reason) for one, reason in zip(model.effects, reasons, strict=True) if reason)
    return with_only(known, [not reason for reason in reasons]), left_out


def _why_left_out(effect: Effect) -> str:
    """Empty for an effect that is simulated."""
    if effect.of_measurements and not (isinstance(effect, SecondVariable) and effect.quantity):
        return OF_MEASUREMENTS
    if isinstance(effect, Added) and np.any(np.ptp(effect.signal(np.arange(16) / 16), axis=-1) > 0):
        return OF_PERIOD
    return ""


def _settled(model: Model, batch: Batch, point: FloatArray) -> Flow:
    where = f"at the operating point ({', '.join(f'{value:g}' for value in point)})"
    try:
        with np.errstate(all="ignore"):
            flow = model.respond(batch)
    except NoSteadyStateError as error:
        raise NoSteadyStateError(
            f"{where} no steady state was found: the effects are too strong for this input; play it at a lower level",
            "input",
        ) from error
    if flow.closing is not None and not flow.closing.stable:
        raise NoSteadyStateError(
            f"{where} the output does not repeat from period to period: small changes of the steady state grow, as the"
            " effects are too strong for this input; play it at another level",
            "input",
        )
    _require_stable(model, flow, where)
    _require_mean_known(model, flow, where)
    return flow


def _require_stable(model: Model, flow: Flow, where: str) -> None:
    structure = model.structure
    poles = structure.poles(flow.setting.zeta)
    if not np.all(abs(poles) < 1 if structure.is_discrete else poles.real < 0):
        raise NoSteadyStateError(
            f"{where} the plant of the model is unstable, so there is no steady state", "operating_points"
        )
    if not np.all(np.isfinite(flow.output)):
        raise RangeError(f"{where} the output leaves the range of numbers; choose other units", "input")


def _require_mean_known(model: Model, flow: Flow, where: str) -> None:
    """Raises MisuseError where a mean value acts on effects such as an integrator or diffusion."""
    if abs(flow.drive[0, 0]) <= NEGLIGIBLE * np.linalg.norm(flow.drive):
        return
    kinds = [one.effect.kind for one in model.effects if _jumps_at_zero(one, flow)]
    if kinds:
        raise MisuseError(
            f"{where} the plant is driven with the mean value {flow.drive[0, 0].real:g}, and what {', '.join(kinds)}"
            " makes of a mean value is not known; play an input without one",
            "input",
        )


def _jumps_at_zero(one: PlacedEffect, flow: Flow) -> bool:
    """Whether its response at ω = 0 is not what it tends to there, against its size at the lowest line."""
    e = one.amplitude(flow.setting, flow.batch)
    omega = flow.batch.omega[1] * np.array([0.0, 1e-12, 1.0])
    if isinstance(one.effect, Factor):
        still, near, lowest = one.effect.factor_at(e, flow.setting.points, omega)[0]
    elif isinstance(one.effect, Parallel):
        still, near, lowest = one.effect.response_at(e, flow.setting.points, omega)[0]
    else:
        return False
    return bool(abs(near - still) > 1e-3 * abs(lowest))


def _deviation(model: Model, batch: Batch, flow: Flow, count: int) -> FloatArray | None:
    """The root of the variance of the output (L,), from central differences of the simulation."""
    assert model.joint_covariance is not None
    further = [np.zeros(model.plant_size)]
    further += [np.concatenate([np.zeros(one.size), 1 / one.effect.values()]) for one in model.effects]
    relative = np.concatenate(further)
    variance = np.zeros(count)
    for direction in covariance_root(model.joint_covariance).T:
        size = STEP / max(1.0, float(abs(direction * relative).max()))
        try:
            up, down = (
                model.with_parameters(model.parameters + sign * size * direction).respond(batch, flow).output
                for sign in (1, -1)
            )
        except NoSteadyStateError:
            return None
        variance += (_samples(batch, up - down, count) / (2 * size)) ** 2
    return np.sqrt(variance)
