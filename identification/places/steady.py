"""The steady state of a plant in the loop of its forces, and how a change inside it comes out."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.places.fine import FineGrid
from identification.places.linearised import Linearised
from identification.places.loop import Loop
from identification.places.marching import MOST_PERIODS, marched
from identification.places.mixing import mixed

TOLERANCE, STALLED = 1e-8, 1e-5
MIXING, PATIENCE, NEWTON, HALVINGS = 120, 8, 60, 4
PROVED, FEWER, ROUGH, KICKS = 12, 4, 0.02, 8
SMALLEST_SHARE, MARGIN = 1 / 16, 0.02
SHARPENED = (0.3, 0.15, 0.08, 0.04, 0.02, 0.01)


class NoSteadyStateError(MisuseError):
    """The steady state of a plant with its forces was not found: there is none, or it does not repeat each period."""


def steady(loop: Loop, start: ComplexArray | None = None) -> ComplexArray:
    """The unknowns of the steady state; from `start`, or else from the response without forces.

    Steps are mixed first, then Newton's; without a start, forces that are too strong at once are followed in time until
    the motion repeats, and what jumps is rounded off and sharpened again; where plants have no states they grow from a
    part to the whole. Raises NoSteadyStateError where that does not lead to one.
    """
    if start is not None:
        return _settled(loop, start)
    plants = None if loop.between or any(effect.remembers for effect, _ in loop.forces) else loop.plants
    if plants is None:
        return _grown(loop)
    try:
        return _settled(loop, loop.start(loop.driven))
    except NoSteadyStateError:
        free = loop.free_motion
        with np.errstate(over="ignore", invalid="ignore"):
            force = marched(loop, plants, free, MOST_PERIODS)
        x = loop.of_force(force)
        for width in SHARPENED:
            x = _settled(loop.rounded(width), x)
        return _settled(loop, x)


def _grown(loop: Loop) -> ComplexArray:
    share, step, x = 0.0, 1.0, loop.start(loop.driven)
    while share < 1:
        try:
            x = _settled(loop.part(share + step), x)
        except NoSteadyStateError:
            step /= 4
            if step < SMALLEST_SHARE:
                raise
            continue
        share += step
    return x


def _settled(loop: Loop, x: ComplexArray) -> ComplexArray:
    with np.errstate(over="ignore", invalid="ignore"):
        x, done = _mixed(loop, x)
        return x if done else _newton(loop, x)


def _mixed(loop: Loop, x: ComplexArray) -> tuple[ComplexArray, bool]:
    """Anderson's mixing of the last steps, as long as it leads down; the best unknowns, and whether they are it."""
    steps: list[ComplexArray] = []
    values: list[ComplexArray] = []
    best, sizes = x, [np.inf]
    for i in range(MIXING):
        value = loop.update(x)
        difference = value - x
        size = _error(difference, value)
        if not np.isfinite(size) or size > 1e3 * min(sizes):
            break
        if size < min(sizes):
            best = x
        sizes.append(size)
        if size <= TOLERANCE:
            return value, True
        if i >= PATIENCE and min(sizes) > 0.5 * min(sizes[:-PATIENCE]):
            break
        steps, values = [*steps[-4:], difference], [*values[-4:], value]
        x = mixed(steps, values)
    return best, False


def _newton(loop: Loop, x: ComplexArray) -> ComplexArray:
    """Newton's method, each record with its own length of the step; given up sooner where it is only nearly one.

    That is so where plants are followed between their samples.
    """
    rest = loop.update(x) - x
    sizes = [_errors(rest, x)]
    kicks, patience = (0, FEWER) if loop.between else (KICKS, PROVED)
    for _ in range(NEWTON):
        step = Linearised(loop, x).solve(rest, ROUGH)
        before = x
        x, rest, moved = _line_search(loop, x, rest, step)
        size = _errors(rest, x)
        if kicks and loop.jumps and np.any((size > TOLERANCE) & (size > 0.99 * sizes[-1])):
            x, rest, kicks, moved = *_kicked(loop, before, step, x, rest, size > 0.99 * sizes[-1]), kicks - 1, True
            size = _errors(rest, x)
        if np.all(size <= TOLERANCE) or (np.all(size <= STALLED) and not moved):
            return x
        sizes.append(size)
        waiting = size > TOLERANCE
        stuck = len(sizes) > patience and np.all(size[waiting] > 0.5 * sizes[-1 - patience][waiting])
        if not moved or not np.all(np.isfinite(size)) or stuck:
            break
    if _error(rest, x) <= STALLED:
        return x
    raise NoSteadyStateError("no steady state was found for this effect; its amplitude may be too large", "effects")


def _kicked(
    loop: Loop, before: ComplexArray, step: ComplexArray, x: ComplexArray, rest: ComplexArray, still: BoolArray
) -> tuple[ComplexArray, ComplexArray]:
    """The whole step for the records that no part of it improves: over a corner the way may lead upwards first."""
    trial = np.where(still[:, None], before + step, x)
    left = loop.update(trial) - trial
    usable = still & np.all(np.isfinite(left), axis=1)
    return np.where(usable[:, None], trial, x), np.where(usable[:, None], left, rest)


def _line_search(
    loop: Loop, x: ComplexArray, rest: ComplexArray, step: ComplexArray
) -> tuple[ComplexArray, ComplexArray, bool]:
    before = np.linalg.norm(rest, axis=1)
    length = np.ones(len(x))
    best, best_rest = x.copy(), rest.copy()
    least = before.copy()
    for _ in range(HALVINGS):
        trial = x + length[:, None] * step
        left = loop.update(trial) - trial
        size = np.linalg.norm(left, axis=1)
        better = np.isfinite(size) & (size < least)
        best[better], best_rest[better], least[better] = trial[better], left[better], size[better]
        waiting = ~(least < before * (1 - 0.1 * length)) & (before > 0)
        if not np.any(waiting):
            break
        length = np.where(waiting, length / 3, length)
    return best, best_rest, bool(np.any(least < 0.99 * before))


def _error(difference: ComplexArray, value: ComplexArray) -> float:
    return float(np.max(_errors(difference, value)))


def _errors(difference: ComplexArray, value: ComplexArray) -> FloatArray:
    size = np.linalg.norm(value, axis=1) + np.finfo(float).tiny
    return np.asarray(np.linalg.norm(difference, axis=1) / size)


@dataclass(frozen=True, eq=False)
class Closing:
    """A change of the lines of the core that forces do not react to yet, turned into one that they react to.

    `x`: the unknowns of the steady state of `loop`, which is that of the fine `grid` where there is one.
    """

    loop: Loop
    x: ComplexArray
    grid: FineGrid | None = None

    @cached_property
    def _linearised(self) -> Linearised:
        return Linearised(self.loop, self.x)

    @property
    def stable(self) -> bool:
        """Whether small changes die out, so that this steady state is reached [Nayfeh1979, Section 5.3]."""
        growth = self._linearised.growth
        return growth is None or bool(np.all(growth < 1 + MARGIN))

    def __call__(self, change: ComplexArray) -> ComplexArray:
        """(M, K) from (M, K)."""
        if self.grid is None:
            return self.loop.split(self._linearised.solve(self.loop.start(change)))[0]
        solved = self._linearised.solve(self.loop.start(self.grid.of(change)))
        return self.grid.sampled(self.loop.split(solved)[0])
