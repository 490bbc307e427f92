"""What is known of the stage beforehand, what is asked, and how it is measured."""

import numpy as np

from app.report.axes import Axes
from app.virtual_plant.campaign import FREQUENCY_SCALE
from app.virtual_plant.stage import DAMPING, LENGTH, MASS, MILLIMETRES, SOFTENING, STIFFNESS
from identification.arrays import FloatArray
from identification.scheduling import SchedulingVariable

POSITION = SchedulingVariable("position", "m", 0.0, LENGTH)
AXES = Axes((POSITION,), "force", "N", "deflection", "mm")

PARAMETERS = ("a1[0]", "a2[0]", "a2[1]", "b0[0]")
MEANINGS = ("damping", "stiffness, drawn in", "stiffness, per m", "gain")
ASKED = np.array([1e-4, 2e-4, 5e-4, 8e-5])
MARGIN = 0.05  # the design rests on an estimate, so it aims a little better than what was asked

FIRST_POSITIONS = (0.0, 0.3, 0.6)
FIRST_LEVEL = 4.0  # N, root mean square
HELD_OUT_LEVEL = 10.0
PERIOD, PERIODS = 512, 4
BAND = (5.0, 160.0)  # rad/s
GRID = 13
TOLERANCE = 1e-4
MOST_EFFECTS = 3


def true_parameters() -> FloatArray:
    """θ, known here because the plant is simulated; nothing but the comparison with the truth uses it."""
    unit = MILLIMETRES / MASS / FREQUENCY_SCALE**2
    return np.array([DAMPING * MILLIMETRES / MASS / FREQUENCY_SCALE, STIFFNESS * unit, -SOFTENING * unit, unit])
