"""Two experiments on a plant with one scheduling variable: a first guess, then the least energy for what is missing.

OPENBLAS_NUM_THREADS=1 python examples/two_stage.py
"""

import numpy as np

from identification.bases.polynomial import Polynomial
from identification.channels import UNSTATED
from identification.lpv.generalised_least_squares import GeneralisedLeastSquares
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord
from identification.simulation import simulate
from oed.design import design
from oed.problem import DesignProblem
from oed.realisation import realise
from oed.spectra.fir import FirSpectra
from oed.targets.parameter_deviation import ParameterDeviation

# The plant y = B/A u + 1/D e with A = 1 + a1 q⁻¹, B = b0 q⁻¹, D = 1 + d1 q⁻¹, each coefficient affine in the speed p.
speed = SchedulingVariable("p", "m/s", 0.0, 8.0)
structure = RationalStructure(n_a=1, n_b=0, n_k=1, n_d=1, sample_time=1.0)
dependence = ParameterDependence((speed,), (ProductBasis((Polynomial(1),)),) * structure.size)

# In place of a test bench: known parameters, and noise.
theta = np.array([-0.9, 0.1, 10.0, -1.0, -0.7, 0.08])
generator = np.random.default_rng(1)


def measure(point: tuple[float, ...], signal: np.ndarray) -> TimeRecord:
    zeta = dependence.matrix([point])[0] @ theta
    noise = generator.normal(0.0, np.sqrt(0.5), len(signal))
    return TimeRecord(signal, simulate(structure, zeta, signal, noise), 1.0, point, channels=UNSTATED.at_level(0.0))


def main() -> None:
    asked = np.array([0.003, 0.001 / 3, 0.1 / 3, 0.01 / 3, 0.35 / 3, 0.04 / 3])

    # First: white noise at four speeds, a local model at each, and θ from all of them.
    local_estimator = PredictionError(initial_conditions="zero")
    first = [measure((p,), generator.normal(0.0, np.sqrt(0.75), 1000)) for p in (0.0, 3.0, 5.5, 8.0)]
    local = [local_estimator.estimate(structure, record) for record in first]
    initial = GeneralisedLeastSquares().estimate(structure, dependence, first, local).model
    report("after the first experiment", initial.covariance, asked)

    # Second: the least input energy that brings the rest.
    problem = DesignProblem(
        model=initial,
        points=np.arange(0.0, 8.5, 0.5)[:, None],
        targets=(ParameterDeviation(tuple(asked)),),
        family=FirSpectra(degree=10),
        samples=1000,
        prior_information=np.linalg.inv(initial.covariance),
    )
    found = design(problem)
    print(f"\nenergy {found.total_energy:.1f}, at least {found.lower_bound:.1f}, gap {found.gap:.1e}")
    for experiment in found.experiments:
        print(f"  p = {experiment.operating_point[0]:g} m/s: energy {experiment.energy:.1f}")

    # Played as multisines, and θ from everything.
    second = []
    for experiment in found.experiments:
        signal = realise(experiment, 100, 1.0, generator=generator, periods=10, amplitude_limit=1.5)
        second.append(measure(experiment.operating_point, signal.record()))
    estimate = JointLikelihood(initial_conditions="zero").estimate(structure, dependence, [*first, *second])
    report("\nafter both", estimate.model.covariance, asked)
    print(
        f"{estimate.outcome.status}; errors in σ: {np.round((estimate.model.theta - theta) / deviations(estimate), 1)}"
    )


def deviations(estimate) -> np.ndarray:
    return np.sqrt(np.diag(estimate.model.covariance))


def report(when: str, covariance: np.ndarray, asked: np.ndarray) -> None:
    print(f"{when}: σ in % of what is asked: {np.round(100 * np.sqrt(np.diag(covariance)) / asked, 1)}")


if __name__ == "__main__":
    main()
