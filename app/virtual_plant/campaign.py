"""What is known of the stage beforehand, and the measurements that an example begins with."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.virtual_plant.multisine import random_phases
from app.virtual_plant.stage import LENGTH, Stage
from identification.arrays import FloatArray
from identification.signals import TimeRecord

SAMPLE_TIME = 0.008
PERIOD, PERIODS = 512, 4
HIGHEST_LINE = 100
POSITIONS = tuple(LENGTH * i / 5 for i in range(6))
HELD_OUT = (0.07, 0.27, 0.5)
LEVELS = (10.0, 5.0)  # N
FREQUENCY_SCALE = 60.0

PLANT: dict[str, Any] = {
    "name": "Positioning stage (simulated)",
    "description": "A stage on a screw, pushed by a force; the farther out it stands, the softer it is. Damping and"
    " gain are taken to be constant, the stiffness to be affine in the position.",
    "schedulingVariables": [{"name": "position", "unit": "m", "minimum": 0.0, "maximum": LENGTH}],
    "input": {"name": "force", "unit": "N"},
    "output": {"name": "deflection", "unit": "mm"},
    "structure": {"timeDomain": "continuous", "na": 2, "nb": 0, "frequencyScaleRadPerSecond": FREQUENCY_SCALE},
    "basis": {"factors": [{"kind": "polynomial", "degree": 0}]},
    "coefficientBases": [{"coefficient": "a2", "basis": {"factors": [{"kind": "polynomial", "degree": 1}]}}],
}
"""The plant as the service describes one."""


@dataclass(frozen=True)
class Campaign:
    """Records of an example: to identify from, and at other positions to judge by."""

    fitted: tuple[TimeRecord, ...]
    held_out: tuple[TimeRecord, ...]


def first_campaign(stage: Stage, generator: np.random.Generator) -> Campaign:
    """Random-phase multisines at six positions and two levels, and at three positions between them."""
    positions = np.repeat(POSITIONS, len(LEVELS))
    levels = np.tile(LEVELS, len(POSITIONS))
    known = np.concatenate([positions, HELD_OUT])
    forces = random_phases(np.concatenate([levels, np.full(len(HELD_OUT), LEVELS[0])]), PERIOD, HIGHEST_LINE, generator)
    records = measured(stage, known, forces, PERIODS, generator)
    return Campaign(records[: len(positions)], records[len(positions) :])


def measured(
    stage: Stage,
    positions: FloatArray,
    forces: FloatArray,
    periods: int,
    generator: np.random.Generator,
    sample_time: float = SAMPLE_TIME,
) -> tuple[TimeRecord, ...]:
    """The records of one period of forces (M, L), played `periods` times at each position (M,)."""
    deflections = stage.measure(positions, forces, sample_time, periods, generator)
    period = forces.shape[1] if periods > 1 else None
    return tuple(
        TimeRecord(np.tile(u, periods), y, sample_time, (float(s),), period)
        for s, u, y in zip(positions, forces, deflections, strict=True)
    )
