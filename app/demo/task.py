"""What is known of the plant beforehand, and what is asked: the example of [Ghosh2018, Section 5]."""

import numpy as np

from app.report.axes import Axes
from identification.bases.polynomial import Polynomial
from identification.models import LpvModel, RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

SAMPLE_TIME = 1.0
VELOCITY = SchedulingVariable("v", "m/s", 0.0, 8.0)
AXES = Axes((VELOCITY,), "heater power", "kW", "outlet temperature", "K")

STRUCTURE = RationalStructure(n_a=1, n_b=0, n_k=1, n_d=1, sample_time=SAMPLE_TIME)
DEPENDENCE = ParameterDependence((VELOCITY,), (ProductBasis((Polynomial(1),)),) * STRUCTURE.size)
PARAMETERS = DEPENDENCE.parameter_names(STRUCTURE.coefficient_names)

FIRST_POINTS = (0.0, 3.0, 5.5, 8.0)
FIRST_POWER = 0.75**0.5  # kW, the amplitude of the random binary signal

GRID = np.arange(0.0, 8.25, 0.5)[:, None]
ASKED = np.array([0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3])
MARGIN = 0.05  # the design rests on an estimate, so it aims a little better than what was asked
SAMPLES = 1000
PERIOD = 200
AMPLITUDE_LIMIT = 1.0  # kW
FIR_DEGREE = 10
TOLERANCE = 1e-4


def true_model() -> LpvModel:
    """The plant as a model, known here because the plant is simulated; nothing but the comparison uses it."""
    theta = np.array([-0.9, 0.1, 10.0, -1.0, -0.7, 0.08])
    return LpvModel(STRUCTURE, DEPENDENCE, theta, np.zeros((6, 6)), 0.5)
