"""A resonance in continuous time: know its gain to 1 % at every load, with sines that a generator can play.

OPENBLAS_NUM_THREADS=1 python examples/response_accuracy.py
"""

import numpy as np

from identification.bases.chebyshev import Chebyshev
from identification.confidence import gain_and_phase
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from oed.design import design
from oed.problem import DesignProblem
from oed.realisation import realise
from oed.spectra.lines import LineSpectra
from oed.targets.response_deviation import ResponseDeviation

load = SchedulingVariable("load", "kg", 0.0, 5.0)
structure = RationalStructure(n_a=2, n_b=0, frequency_scale=100.0)
dependence = ParameterDependence((load,), (ProductBasis((Chebyshev(1),)),) * structure.size)

# What is assumed beforehand: damping, stiffness and gain, in powers of 100 rad/s, falling with the load.
theta = np.array([0.06, -0.01, 1.0, -0.2, 0.8, -0.15])
SAMPLE_TIME = 0.002
SAMPLES = 2048


def main() -> None:
    prior = Model(structure, dependence, theta, np.zeros((6, 6)), noise_variance=1e-4)
    loads = np.linspace(0.0, 5.0, 11)[:, None]
    accurate = ResponseDeviation(
        operating_points=((0.0,), (2.5,), (5.0,)),
        minimum_rad_per_second=20.0,
        maximum_rad_per_second=200.0,
        standard_deviation=0.01 / 1.96,
    )
    problem = DesignProblem(
        prior, loads, (accurate,), LineSpectra(SAMPLES), SAMPLES, band=(10.0, 400.0), sample_time=SAMPLE_TIME
    )
    found = design(problem)
    print(f"{found.outcome.status}: energy {found.total_energy:.4g}, at least {found.lower_bound:.4g}")
    for experiment in found.experiments:
        signal = realise(experiment, SAMPLES, SAMPLE_TIME, generator=1, periods=4)
        place = f"load {experiment.operating_point[0]:g} kg"
        lines = ", ".join(f"{omega:.1f}" for omega in experiment.spectrum.frequencies)
        print(f"  {place}: lines at {lines} rad/s, crest factor {signal.crest_factor:.2f}")

    expected = Model(structure, dependence, theta, found.expected_covariance, prior.noise_variance)
    omega = np.geomspace(20.0, 200.0, 200)
    for point in accurate.operating_points:
        response = expected.frequency_response([point], omega)[0, :, 0, 0]
        known = gain_and_phase(response, expected.response_covariance([point], omega)[0, :, 0, 0])
        worst = 196 * np.max(known.gain_deviation / known.gain)
        print(f"  load {point[0]:g} kg: gain known to ±{worst:.2f} % from 20 to 200 rad/s")


if __name__ == "__main__":
    main()
