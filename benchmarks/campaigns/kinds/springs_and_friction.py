"""Laws of a stage in periodic records, whatever of its motion is measured."""

import numpy as np

from benchmarks.campaigns import laws
from benchmarks.campaigns.campaign import Campaign, Truth
from benchmarks.campaigns.stage import PERIODS, Stage, played, stage


def _coulomb(case: str, g: np.random.Generator, order: int, periods: tuple[int, ...] = (PERIODS,)) -> Campaign:
    force = g.uniform(0.05, 0.2)
    truth = Truth(("coulomb_friction",), amplitude=force)
    return played(case, truth, stage(g, order), g, lambda q, v: laws.coulomb(force, v), periods=periods)


def _cubic(case: str, g: np.random.Generator, order: int, shares: tuple[float, float]) -> Campaign:
    plant = stage(g, order)
    coefficient = g.uniform(*shares) * _softness(plant, g)
    truth = Truth(("cubic_stiffness",), amplitude=coefficient)
    return played(case, truth, plant, g, lambda q, v: laws.power(coefficient, 3))


def _softness(plant: Stage, g: np.random.Generator, exponent: int = 3) -> float:
    """The coefficient at which the force at the rms displacement of 1 N rms is that of the spring."""
    amplitudes, lines = plant.multisine(8, g)
    q, _ = plant.motion(amplitudes, lines)
    return plant.stiffness / q ** (exponent - 1)


def coulomb_friction(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction, a position measured."""
    return _coulomb(case, g, 0)


def coulomb_at_a_velocity(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction, a velocity measured."""
    return _coulomb(case, g, 1)


def coulomb_at_an_acceleration(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction, an acceleration measured."""
    return _coulomb(case, g, 2)


def coulomb_unequal_lengths(case: str, g: np.random.Generator) -> Campaign:
    """Dry friction, records of 3, 4 and 6 periods."""
    return _coulomb(case, g, 0, (4, 3, 6))


def drag_of_a_stage(case: str, g: np.random.Generator) -> Campaign:
    """Quadratic damping of a third to all of the linear one at the rms speed."""
    plant, order = stage(g), int(g.integers(0, 3))
    plant = Stage(**(vars(plant) | {"order": order}))
    amplitudes, lines = plant.multisine(8, g)
    coefficient = g.uniform(0.3, 1.0) * plant.damping / plant.motion(amplitudes, lines)[1]
    truth = Truth(("quadratic_damping",), amplitude=coefficient)
    return played(case, truth, plant, g, lambda q, v: laws.drag(coefficient))


def cubic_spring(case: str, g: np.random.Generator) -> Campaign:
    """A hardening spring, faint to strong."""
    return _cubic(case, g, 0, (0.01, 0.15))


def hardening_spring(case: str, g: np.random.Generator) -> Campaign:
    """A hardening spring that bends the resonance."""
    return _cubic(case, g, 0, (0.15, 0.5))


def cubic_at_a_velocity(case: str, g: np.random.Generator) -> Campaign:
    """A hardening spring, a velocity measured."""
    return _cubic(case, g, 1, (0.01, 0.15))


def quintic_spring(case: str, g: np.random.Generator) -> Campaign:
    """A law that the library does not have."""
    plant = stage(g)
    coefficient = g.uniform(0.02, 0.1) * _softness(plant, g, 5)
    return played(case, Truth(("law",)), plant, g, lambda q, v: laws.power(coefficient, 5))


def stribeck(case: str, g: np.random.Generator) -> Campaign:
    """Friction that falls with speed."""
    force, more, share = g.uniform(0.08, 0.2), g.uniform(0.5, 1.2), g.uniform(0.2, 0.7)
    truth = Truth(("stribeck_friction",))
    return played(case, truth, stage(g), g, lambda q, v: laws.stribeck(force, more, share * v, v))


def asymmetric_friction(case: str, g: np.random.Generator) -> Campaign:
    """Friction that differs by the direction."""
    low, high = g.uniform(0.04, 0.08), g.uniform(0.12, 0.25)
    one, other = (high, low) if g.random() < 0.5 else (low, high)
    truth = Truth(("asymmetric_friction", ("coulomb_friction", "actuator_offset")))
    return played(case, truth, stage(g), g, lambda q, v: laws.asymmetric(one, other, v))
