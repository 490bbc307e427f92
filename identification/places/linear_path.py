"""What acts linearly between the core of a plant and its sensor, and its images where the input is held."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.models.hold import hold_factor
from identification.places.linear import Factor, Parallel
from identification.places.place import Effect, Setting
from identification.signals import HeldInput

IMAGES = 12


@dataclass(frozen=True, eq=False)
class LinearPath:
    """Y = factor · (X + within · U) + beside · U, each (M, K) or one number; `acts`: whether it is more than Y = X."""

    factor: ComplexArray
    within: ComplexArray
    beside: ComplexArray
    acts: bool


def linear_path(acting: Sequence[tuple[Effect, FloatArray]], points: FloatArray, omega: FloatArray) -> LinearPath:
    """The path of all effects with their amplitudes e (shapes, M) at scaled points (M, s) and ω ≥ 0 (K,)."""
    factor, within, beside = (np.full((1, 1), one, dtype=np.complex128) for one in (1.0, 0.0, 0.0))
    acts = False
    for effect, e in acting:
        if isinstance(effect, Factor):
            factor = factor * effect.factor_at(e, points, omega)
        elif isinstance(effect, Parallel) and effect.within:
            within = within + effect.response_at(e, points, omega)
        elif isinstance(effect, Parallel):
            beside = beside + effect.response_at(e, points, omega)
        acts = acts or isinstance(effect, Factor | Parallel)
    return LinearPath(factor, within, beside, acts)


def images(
    setting: Setting, acting: Sequence[tuple[Effect, FloatArray]], omega: FloatArray, held: HeldInput
) -> ComplexArray:
    """What the images of a held input add to Y/U (M, K) on a path, beyond what the core alone makes of them.

        Σ_m h(ω_m) ((f(ω_m) − f(ω)) G(ω_m) + f(ω_m) w(ω_m) + b(ω_m)),   ω_m = ω + 2πm/T,   m = ±1 … ±12

    with h = P/T of the hold; factor f, modes w and paths b from `linear_path`, conjugate at negative frequencies.
    """
    found = np.zeros((len(setting.zeta), len(omega)), dtype=np.complex128)
    here = linear_path(acting, setting.points, omega)
    for m in range(1, IMAGES + 1):
        for sign in (1, -1):
            image = omega + sign * m * 2 * np.pi / held.step
            path = linear_path(acting, setting.points, abs(image))
            factor, within, beside = (
                one if sign > 0 else one.conj() for one in (path.factor, path.within, path.beside)
            )
            core = setting.structure.plant_response(setting.zeta, image)
            change = (factor - here.factor) * core + factor * within + beside
            found += hold_factor(image, held) * change
    return found
