"""Steady response of a plant with effects, in the frequency domain."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.places.linear import Coefficient, Factor, FrequencyAxis, Parallel
from identification.places.nonlinear import Actuator, Added, Feedback, Sensor
from identification.places.place import Effect, Flow, Setting, derivative

Acting = tuple[Effect, FloatArray]
Update = Callable[[ComplexArray], ComplexArray]
Solver = Callable[[Update, ComplexArray, int], ComplexArray]
MEMORY, LIMIT = 4, 60
DIVERGED = 1e3


class NoSteadyStateError(MisuseError):
    """The fixed point of the feedback was not found: the effect is too strong to be computed from this start."""


def simulate(
    setting: Setting,
    acting: Sequence[Acting],
    batch: Batch,
    start: ComplexArray | None = None,
    solve: Solver | None = None,
) -> Flow:
    """The signals of a batch at the coefficients of `setting` for effects with amplitudes e (shapes, M).

        u → g(u) → [ X = G (U − F{f(x, ẋ)}) ] → + modes → · factor, + parallel → h(y) → + d(t)

    `start` (M, K): X to begin the search for the fixed point with; `solve` finds it, `fixed_point` when not given.
    Raises NoSteadyStateError when there is none to be found, and MisuseError for effects that need records when the
    batch holds frequency responses.
    """
    if batch.signals is None and any(effect.needs_records for effect, _ in acting):
        raise MisuseError("effects that act on signals need periodic records", "effects")
    setting = _changed(setting, acting)
    gradient = setting.structure.plant_gradient(setting.zeta, batch.omega)
    response = _response(setting, acting, batch)
    entering = _actuated(setting, acting, batch)
    finer = _finer(setting, acting, Feedback)
    core, drive = _core(response, entering, _forces(acting), batch, start, finer, solve or fixed_point)
    factor, within, beside = np.ones_like(response), core, np.zeros_like(core)
    for effect, e in acting:
        if isinstance(effect, Factor):
            factor = factor * effect.factor(e[0][:, None], batch.omega)
        elif isinstance(effect, Parallel) and effect.within:
            within = within + effect.response(e, batch.omega) * drive
        elif isinstance(effect, Parallel):
            beside = beside + effect.response(e, batch.omega) * drive
    factored = factor * within
    linear = factored + beside
    output = _measured(linear, acting, batch)
    return Flow(batch, setting, response, gradient, drive, core, factored, linear, output, factor)


def _changed(setting: Setting, acting: Sequence[Acting]) -> Setting:
    zeta = setting.zeta.copy()
    for effect, e in acting:
        if isinstance(effect, Coefficient):
            zeta[:, : setting.structure.n_plant] += e[0][:, None] * effect.direction(setting)
    return dataclasses.replace(setting, zeta=zeta)


def _response(setting: Setting, acting: Sequence[Acting], batch: Batch) -> ComplexArray:
    for effect, e in acting:
        if isinstance(effect, FrequencyAxis):
            return effect.response(e[0], setting.structure, setting.zeta, batch.omega)
    return setting.structure.plant_response(setting.zeta, batch.omega)


def _finer(setting: Setting, acting: Sequence[Acting], place: type[Actuator] | type[Feedback]) -> int:
    """The finest time grid that one of the effects in a place wants; the samples in discrete time."""
    if setting.structure.is_discrete:
        return 1
    return max((effect.oversampling for effect, _ in acting if isinstance(effect, place)), default=1)


def _actuated(setting: Setting, acting: Sequence[Acting], batch: Batch) -> ComplexArray:
    found = [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Actuator)]
    if not found:
        return batch.inputs
    signal = batch.signal(batch.inputs, _finer(setting, acting, Actuator))
    for effect, e in found:
        signal = signal + e * effect.shape(signal)
    return batch.spectrum(signal)


def _forces(acting: Sequence[Acting]) -> list[tuple[Feedback, FloatArray]]:
    return [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Feedback)]


def _core(
    response: ComplexArray,
    entering: ComplexArray,
    forces: Sequence[tuple[Feedback, FloatArray]],
    batch: Batch,
    start: ComplexArray | None,
    finer: int,
    solve: Solver,
) -> tuple[ComplexArray, ComplexArray]:
    """X and the drive U − F{f} (M, K)."""
    if not forces:
        return response * entering, entering

    def drive(core: ComplexArray) -> ComplexArray:
        x, velocity = batch.signal(core, finer), batch.signal(derivative(core, batch), finer)
        total = np.zeros_like(x)
        for effect, e in forces:
            total += e * effect.force(x, velocity)
        return np.asarray(entering - batch.spectrum(total))

    first, limit = (response * entering, 3 * LIMIT) if start is None else (start, LIMIT)
    core = solve(lambda x: response * drive(x), first, limit)
    return core, drive(core)


def _measured(linear: ComplexArray, acting: Sequence[Acting], batch: Batch) -> ComplexArray:
    sensors = [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Sensor)]
    output = linear
    if sensors:
        signal = batch.signal(linear)
        for sensor, e in sensors:
            signal = signal + e * sensor.shape(signal)
        output = batch.spectrum(signal)
    for effect, e in acting:
        if isinstance(effect, Added):
            output = output + np.einsum("im,ik->mk", e, effect.lines(batch))
    return output


def fixed_point(update: Update, start: ComplexArray, limit: int = LIMIT, tolerance: float = 1e-8) -> ComplexArray:
    """X = update(X) (M, K), each row by itself, by Anderson's mixing of the last four steps.

    Raises NoSteadyStateError when a row has not settled to `tolerance` of its size after `limit` steps.
    """
    x, scale = start, float(np.linalg.norm(start)) + 1.0
    steps: list[ComplexArray] = []
    values: list[ComplexArray] = []
    for _ in range(limit):
        with np.errstate(over="ignore", invalid="ignore"):
            value = update(x)
        difference = value - x
        if not np.all(np.isfinite(difference)) or np.linalg.norm(difference) > DIVERGED * scale:
            break
        size = np.linalg.norm(value, axis=1)
        if np.all(np.linalg.norm(difference, axis=1) <= tolerance * size + np.finfo(float).tiny):
            return value
        steps, values = [*steps[-MEMORY:], difference], [*values[-MEMORY:], value]
        x = _mixed(steps, values)
    raise NoSteadyStateError("no steady state was found for this effect; its amplitude may be too large", "effects")


def _mixed(steps: list[ComplexArray], values: list[ComplexArray]) -> ComplexArray:
    """Σ α_i values_i with Σ α_i = 1 that makes ‖Σ α_i steps_i‖ least, in each row."""
    if len(steps) == 1:
        return values[0]
    last = steps[-1]
    changes = np.stack([last - other for other in steps[:-1]], axis=1)
    gram = np.einsum("mik,mjk->mij", changes.conj(), changes).real
    target = np.einsum("mik,mk->mi", changes.conj(), last).real
    ridge = 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] + np.finfo(float).tiny
    weights = np.linalg.solve(gram + ridge * np.eye(len(steps) - 1), target[..., None])[..., 0]
    offsets = np.stack([values[-1] - other for other in values[:-1]], axis=1)
    return np.asarray(values[-1] - np.einsum("mi,mik->mk", weights, offsets))
