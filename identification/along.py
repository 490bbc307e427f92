"""Parameter-varying models simulated along p(t), with the standard deviation of the output."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.confidence import covariance_root
from identification.errors import RangeError
from identification.models.model import Model
from identification.models.structure import Along

UNSTABLE = "the simulated output grows beyond all numbers: the model is unstable along this scheduling"


@dataclass(frozen=True, eq=False)
class Simulation:
    """The output (N, n_y) from rest, and its standard deviation (N, n_y) by the covariance of the model, or None."""

    output: FloatArray
    deviation: FloatArray | None


def simulate_along(
    model: Model, input: FloatArray, scheduling: FloatArray, covariance_known: bool = True
) -> Simulation:
    """A model in discrete time without delay from rest, its coefficients following p (N, s) at once, for u (N, n_u).

        cov y(t) = S(t) P S(t)ᵀ,   S = ∂y/∂θ_G

    Identified at frozen operating points, the model says nothing of what fast changes of p do; this is the plant that
    they have no effect of their own on. Raises MisuseError for continuous time or a delay, RangeError for p outside
    its range or an output that grows beyond all numbers.
    """
    found = model.structure.along(model.coefficients(scheduling), input)
    if not np.all(np.isfinite(found.output)):
        raise RangeError(UNSTABLE, "scheduling")
    if not covariance_known:
        return Simulation(found.output, None)
    variance = sum((dy**2 for dy in _changes(model, found, scheduling)), np.zeros_like(found.output))
    return Simulation(found.output, np.sqrt(variance))


def output_changes(model: Model, input: FloatArray, scheduling: FloatArray) -> Iterator[FloatArray]:
    """S(t) v (N, n_y) for one direction v after the other, Σ v vᵀ = P; S as in `simulate_along`."""
    return _changes(model, model.structure.along(model.coefficients(scheduling), input), scheduling)


def _changes(model: Model, found: Along, scheduling: FloatArray) -> Iterator[FloatArray]:
    for direction in covariance_root(model.plant_covariance).T:
        moved = model.dependence.coefficients(model.direction(direction), scheduling)
        yield found.change(moved[:, : model.structure.n_plant])
