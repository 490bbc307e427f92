"""The core of a plant: its structure at given coefficients, reshaped by effects that act within it."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.place import Effect, Flow, Setting
from identification.signals import HeldInput

Plant = Callable[[FloatArray, FloatArray, HeldInput | None], ComplexArray]
STEP, BY_COEFFICIENT = 1e-4, 1e-5


@dataclass(frozen=True)
class Reshaped(Effect):
    """Makes another response of the plant's own, G(ω; ζ) → Ĝ(ω; ζ, e); `on_entry`: only as the input is seen."""

    place: ClassVar[str] = "response of the plant itself"
    on_entry: ClassVar[bool] = False

    @abstractmethod
    def reshaped(
        self, e: FloatArray, plant: Plant, setting: Setting, omega: FloatArray, held: HeldInput | None
    ) -> ComplexArray:
        """Ĝ (M, K) for e (M,), where `plant` (ζ, ω, hold) gives what is reshaped, (M, K)."""

    def small(self, flow: Flow) -> float:
        """A small amplitude, for differences."""
        return STEP

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K), from central differences of Ĝ."""
        step = self.small(flow)
        return flow.through((self.seen(e + step, flow) - self.seen(e - step, flow)) / (2 * step))[None]

    def seen(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """What leaves the core (M, K) at the amplitude e (1, M), the forces in the loop as they are."""
        acting = [*(one for one in flow.acting if type(one[0]) is not type(self)), (self, e)]
        forces = flow.entering - flow.drive
        core = core_response(flow.setting, acting, flow.batch.omega, flow.held, True) * flow.entering
        if np.any(forces):
            core = core - core_response(flow.setting, acting, flow.batch.omega) * forces
        return np.asarray(core)


def core_response(
    setting: Setting,
    acting: Sequence[tuple[Effect, FloatArray]],
    omega: FloatArray,
    held: HeldInput | None = None,
    entry: bool = False,
) -> ComplexArray:
    """Ĝ (M, K) at the coefficients of `setting` for effects with amplitudes e (shapes, M).

    `entry`: as the input is seen through the hold, and through what is not known of it.
    """
    structure = setting.structure

    def plain(zeta: FloatArray, omega: FloatArray, held: HeldInput | None) -> ComplexArray:
        if setting.channels is not None:
            return structure.channel_response(zeta, omega, setting.channels)
        return structure.plant_response(zeta, omega, held)

    plant: Plant = plain
    for effect, e in acting:
        if isinstance(effect, Reshaped) and (entry or not effect.on_entry):
            plant = _within(effect, e[0], plant, setting)
    return plant(setting.zeta, omega, held)


def _within(effect: Reshaped, e: FloatArray, plant: Plant, setting: Setting) -> Plant:
    def reshaped(zeta: FloatArray, omega: FloatArray, held: HeldInput | None) -> ComplexArray:
        return effect.reshaped(e, plant, replace(setting, zeta=zeta), omega, held)

    return reshaped


def core_gradient(
    setting: Setting,
    acting: Sequence[tuple[Effect, FloatArray]],
    omega: FloatArray,
    held: HeldInput | None = None,
    entry: bool = False,
) -> ComplexArray:
    """∂Ĝ/∂ζ_G (M, n_plant, K): exact, or by central differences where effects reshape the plant."""
    reshaping = [one for one in acting if isinstance(one[0], Reshaped) and (entry or not one[0].on_entry)]
    if not reshaping and setting.channels is not None:
        return setting.structure.channel_gradient(setting.zeta, omega, setting.channels)
    if not reshaping:
        return setting.structure.plant_gradient(setting.zeta, omega, held)
    columns = []
    for i in range(setting.structure.n_plant):
        sizes = abs(setting.zeta[:, i])
        step = BY_COEFFICIENT * np.where(sizes > 0, sizes, abs(setting.zeta).max(axis=1))
        ends = []
        for sign in (1, -1):
            zeta = setting.zeta.copy()
            zeta[:, i] += sign * step
            ends.append(core_response(replace(setting, zeta=zeta), reshaping, omega, held, entry))
        columns.append((ends[0] - ends[1]) / (2 * step)[:, None])
    return np.stack(columns, axis=1)
