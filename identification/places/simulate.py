"""Steady response of a plant with effects, in the frequency domain."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.places.core import Reshaped, core_gradient, core_response
from identification.places.linear import Coefficient, Divisor
from identification.places.linear_path import images, linear_path
from identification.places.nonlinear import Actuator, Added, Feedback, Sensor
from identification.places.place import Effect, Flow, Setting, derivative, passing

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
    held = None if setting.structure.is_discrete else batch.held
    response = core_response(setting, acting, batch.omega)
    seen_otherwise = held is not None or any(isinstance(one, Reshaped) and one.on_entry for one, _ in acting)
    entry = core_response(setting, acting, batch.omega, held, True) if seen_otherwise else response
    entering = _actuated(setting, acting, batch)
    core, drive = _core(response, entry, entering, acting, setting, batch, start, solve or fixed_point)
    path, beside_drive = linear_path(acting, setting.points, batch.omega), passing(drive, entering, batch.omega, held)
    factored = path.factor * (core + path.within * beside_drive)
    linear = factored + path.beside * beside_drive
    if held is not None and path.acts:
        linear = linear + images(setting, acting, batch.omega, held) * entering
    output = _measured(linear, acting, batch)
    return Flow(
        batch,
        setting,
        response,
        entry,
        entering,
        drive,
        core,
        factored,
        linear,
        output,
        path.factor * np.ones_like(core),
        tuple(acting),
        lambda seen: core_gradient(setting, acting, batch.omega, held if seen else None, seen),
    )


def _changed(setting: Setting, acting: Sequence[Acting]) -> Setting:
    """The setting with what effects add to the coefficients, and then divide them by."""
    zeta, n, structure = setting.zeta.copy(), setting.structure.n_plant, setting.structure
    passed = None
    for effect, e in acting:
        if isinstance(effect, Coefficient) and not isinstance(effect, Divisor):
            zeta[:, :n] += e[0][:, None] * effect.direction(setting)
    for effect, e in acting:
        if isinstance(effect, Divisor):
            divisor = effect.divisor(e[0], structure)
            zeta[:, :n] /= divisor
            passed = 1 / divisor if passed is None else passed / divisor
    return dataclasses.replace(setting, zeta=zeta, passed=passed)


def _finer(setting: Setting, acting: Sequence[Acting], place: type[Actuator] | type[Feedback]) -> int:
    """The finest time grid that one of the effects in a place wants; the samples in discrete time."""
    if setting.structure.is_discrete:
        return 1
    return max((effect.oversampling for effect, _ in acting if isinstance(effect, place)), default=1)


def _actuated(setting: Setting, acting: Sequence[Acting], batch: Batch) -> ComplexArray:
    found = [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Actuator)]
    if not found:
        return batch.inputs
    stepped = batch.held is not None and not setting.structure.is_discrete
    signal = batch.signal(batch.inputs, 1 if stepped else _finer(setting, acting, Actuator))
    for effect, e in found:
        signal = signal + e * effect.shape(signal)
    return batch.spectrum(signal)


def _forces(acting: Sequence[Acting]) -> list[tuple[Feedback, FloatArray]]:
    return [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Feedback)]


def _core(
    response: ComplexArray,
    entry: ComplexArray,
    entering: ComplexArray,
    acting: Sequence[Acting],
    setting: Setting,
    batch: Batch,
    start: ComplexArray | None,
    solve: Solver,
) -> tuple[ComplexArray, ComplexArray]:
    """X and the drive U − F{f} (M, K)."""
    forces, driven = _forces(acting), entry * entering
    if not forces:
        return driven, entering
    finer = _finer(setting, acting, Feedback)

    def force(core: ComplexArray) -> ComplexArray:
        x, velocity = batch.signal(core, finer), batch.signal(derivative(core, batch), finer)
        total = np.zeros_like(x)
        for effect, e in forces:
            total += e * effect.force(x, velocity)
        return batch.spectrum(total)

    first, limit = (driven, 3 * LIMIT) if start is None else (start, LIMIT)
    core = solve(lambda x: driven - response * force(x), first, limit)
    return core, entering - force(core)


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
