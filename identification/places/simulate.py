"""Steady response of a plant with effects, in the frequency domain."""

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.places.aliases import aliases
from identification.places.core import Reshaped, core_gradient, core_response
from identification.places.fine import FineGrid, fine_grid
from identification.places.intersample import OFFSETS, Between, is_followed
from identification.places.linear import Coefficient, Divisor
from identification.places.linear_path import images, linear_path
from identification.places.loop import Loop
from identification.places.marching import marched
from identification.places.motion import displacement, flow_rate
from identification.places.nonlinear import Actuator, Added, Feedback, Sensor
from identification.places.place import Effect, Flow, Setting, passing
from identification.places.recorder import Recorder
from identification.places.steady import Closing, NoSteadyStateError, steady
from identification.signals import HeldInput

Acting = tuple[Effect, FloatArray]
FOLLOWED = 2


def simulate(setting: Setting, acting: Sequence[Acting], batch: Batch, start: Flow | None = None) -> Flow:
    """The signals of a batch at the coefficients of `setting` for effects with amplitudes e (shapes, M).

        u → g(u) → [ X = G (U − F{f(q, q̇)}) ] → + modes → · factor, + parallel → h(y) → + d(t) → recorder

    `start`: signals to begin the search for the steady state with; without them it is looked for at forces that grow.
    Raises NoSteadyStateError when there is none to be found, and MisuseError for effects that need records when the
    batch holds frequency responses.
    """
    acting = _composed(acting)
    loop, setting = _prepared(setting, acting, batch)
    if not loop.forces:
        force, mean = np.zeros_like(loop.driven), np.zeros(len(loop.driven))
        core = loop.answer(force) + _reaction(setting, acting, batch)
        return _shown(setting, acting, loop, force, core, core, mean, None)
    grid = fine_grid(loop, setting)
    inner = loop if grid is None else grid.loop(loop, setting, acting)
    x = _steady(inner, start, grid)
    force, mean = inner.force_lines(x)[:, : len(batch.omega)], inner.split(x)[1]
    core = loop.answer(force) + _reaction(setting, acting, batch)
    return _shown(setting, acting, loop, force, core, core, mean, Closing(inner, x, grid))


def from_rest(setting: Setting, acting: Sequence[Acting], batch: Batch) -> Flow:
    """The same for an input in the first half of the signals, from rest; in the second half it is zero.

    Forces are followed in time from the first sample on (`marched`), and a steady state need not exist. They end with
    the first half, so that the plant settles and nothing comes back at the start. Raises
    MisuseError for plants without states, and for forces that remember.
    """
    if not any(isinstance(effect, Feedback) and not effect.driven for effect, _ in acting):
        return simulate(setting, acting, batch)
    loop, setting = _prepared(setting, acting, batch)
    grid = fine_grid(loop, setting)
    inner = loop if grid is None else grid.loop(loop, setting, acting)
    if inner.plants is None or any(effect.remembers for effect, _ in loop.forces):
        raise MisuseError(
            "the forces of this model cannot be followed in time; simulate a period of its output", "effects"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        in_time = marched(inner, inner.plants, inner.free_motion)
    in_time[:, in_time.shape[1] // 2 :] = 0.0
    force = inner.lines_of(in_time)[:, : len(batch.omega)]
    core = loop.answer(force) + _reaction(setting, acting, batch)
    return _shown(setting, acting, loop, force, core, core, np.zeros(len(core)), None)


def _steady(inner: Loop, start: Flow | None, grid: FineGrid | None) -> ComplexArray:
    """From another steady state, from signals that are none (and if that leads nowhere, anew), or anew."""
    if start is None:
        return steady(inner)
    if start.closing is not None and start.closing.x.shape == inner.start(inner.driven).shape:
        return steady(inner, start.closing.x)
    try:
        return steady(inner, inner.start(start.core if grid is None else grid.of(start.core), start.mean))
    except NoSteadyStateError:
        return steady(inner)


def followed(setting: Setting, acting: Sequence[Acting], batch: Batch, measured: ComplexArray) -> Flow:
    """The same with the motion taken from the measured output (M, K) and not from the model: nothing is solved.

        X̄ = ((h⁻¹(Ȳ) − parallel)/factor) − modes,   the output is that of X = G (U − F{f(q̄, q̄̇)})

    with `core` X̄; h⁻¹ to first order in the amplitudes of sensors. Forces do not react to changes.
    """
    acting = _composed(acting)
    loop, setting = _prepared(setting, acting, batch)
    seen = 2 * measured - _measured(measured, acting, batch)
    core, mean, force = seen, np.zeros(len(seen)), np.zeros_like(seen)
    for _ in range(FOLLOWED):
        if loop.forces:
            x = loop.balanced(loop.start(core, mean))
            mean, force = loop.split(x)[1], loop.force_lines(x)
        path = linear_path(acting, setting.points, batch.omega)
        through = passing(loop.entering - force, loop.entering, batch.omega, _held(setting, batch))
        core = (seen - path.beside * through) / path.factor - path.within * through
    predicted = loop.driven - loop.response * force + _reaction(setting, acting, batch)
    return _shown(setting, acting, loop, force, predicted, core, mean, None)


def _composed(acting: Sequence[Acting]) -> list[Acting]:
    return [effect.composed(e) for effect, e in acting]


def _held(setting: Setting, batch: Batch) -> HeldInput | None:
    return None if setting.structure.is_discrete else batch.held


def _prepared(setting: Setting, acting: Sequence[Acting], batch: Batch) -> tuple[Loop, Setting]:
    """The loop, and the coefficients as effects change them."""
    if batch.signals is None and any(effect.needs_records for effect, _ in acting):
        raise MisuseError("effects that act on signals need periodic records", "effects")
    setting = _changed(setting, acting)
    held = _held(setting, batch)
    response = core_response(setting, acting, batch.omega)
    seen_otherwise = held is not None or any(isinstance(one, Reshaped) and one.on_entry for one, _ in acting)
    entry = core_response(setting, acting, batch.omega, held, True) if seen_otherwise else response
    forces = [(effect, e[0][:, None]) for effect, e in acting if isinstance(effect, Feedback) and not effect.driven]
    entering, finer = _actuated(setting, acting, batch), _finer(setting, acting, Feedback)
    if not (setting.structure.is_discrete and is_followed(setting.structure, setting.zeta, batch)):
        return Loop(response, entry, entering, forces, batch, finer, None, setting), setting
    between = Between(setting.structure, setting.zeta, batch)
    return Loop(response, entry, entering, forces, batch, OFFSETS, between, setting), setting


def _reaction(setting: Setting, acting: Sequence[Acting], batch: Batch) -> ComplexArray:
    """The forces of a motion that the input is, (M, K)."""
    total, still = np.zeros_like(batch.inputs), np.zeros(len(batch.points))
    for effect, e in acting:
        if isinstance(effect, Feedback) and effect.driven:
            finer = _finer(setting, acting, Feedback)
            lines = displacement(batch.inputs, still, batch, effect.order), flow_rate(batch.inputs, batch, effect.order)
            q, flow = (batch.signal(one, finer) for one in lines)
            total += e[0][:, None] * effect.lines(batch, q, flow)
    return total


def _shown(
    setting: Setting,
    acting: Sequence[Acting],
    loop: Loop,
    force: ComplexArray,
    predicted: ComplexArray,
    core: ComplexArray,
    mean: FloatArray,
    closing: Closing | None,
) -> Flow:
    """What is seen of a core that gives `predicted` (M, K) at the forces (M, K)."""
    batch, held, drive = loop.batch, _held(setting, loop.batch), loop.entering - force
    path, through = linear_path(acting, setting.points, batch.omega), passing(drive, loop.entering, batch.omega, held)
    factored = path.factor * (predicted + path.within * through)
    linear = factored + path.beside * through
    if held is not None and path.acts:
        linear = linear + images(setting, acting, batch.omega, held) * loop.entering
    linear = linear + _aliased(setting, loop, core, mean, closing)
    shown, recorder = _measured(linear, acting, batch), _recorder(acting, batch)
    output = shown if recorder is None else recorder(shown)
    output, factor = output + batch.transient(output), path.factor * np.ones_like(core)
    made = (loop.response, loop.entry, loop.entering, drive, core, factored, linear, output, factor, tuple(acting))

    def gradient(seen: bool) -> ComplexArray:
        return core_gradient(setting, acting, batch.omega, held if seen else None, seen)

    cache = {} if closing is None or closing.grid is None else _motions(closing)
    return Flow(batch, setting, *made, gradient, mean, closing, loop.between, shown, recorder, cache)


def _recorder(acting: Sequence[Acting], batch: Batch) -> Callable[[ComplexArray], ComplexArray] | None:
    """What the recorder makes of lines (…, M, K) of the output; None where it changes nothing."""
    found = [(effect, e[0]) for effect, e in acting if isinstance(effect, Recorder) and np.any(e)]
    if not found:
        return None

    def recorded(lines: ComplexArray) -> ComplexArray:
        for effect, e in found:
            lines = effect.recorded(e, lines, batch)
        return lines

    return recorded


def _motions(closing: Closing) -> dict[tuple[str, int, int], FloatArray]:
    """Displacement and flow on the fine grid as signals of a flow."""
    assert closing.grid is not None
    found = {}
    for effect, _ in closing.loop.forces:
        q, flow = closing.loop.motion(effect, closing.x)
        found[("q of core", effect.order, closing.grid.n)] = q
        found[("flow of core", effect.order, closing.grid.n)] = flow
    return found


def _aliased(
    setting: Setting, loop: Loop, core: ComplexArray, mean: FloatArray, closing: Closing | None
) -> ComplexArray:
    """What the forces of a motion put beyond the Nyquist frequency, on the lines (M, K) where samples show it."""
    total = np.zeros_like(core)
    followed_between = loop.between is not None or not loop.batch.repeats
    for effect, e in loop.forces if loop.finer > 1 and not followed_between else ():
        fine = closing is not None and closing.grid is not None
        motion = closing.loop.motion(effect, closing.x) if closing is not None and fine else None
        force = effect.force(*(motion or loop.motion(effect, loop.start(core, mean))))
        total += e * aliases(force, effect.differentiated, setting.structure, setting.zeta, loop.batch)
    return total


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
