"""An effect with its amplitude over the scheduling variables: what a model carries."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.place import Effect, Setting


@dataclass(frozen=True, eq=False)
class PlacedEffect:
    """An effect in a model with its amplitude e_i(p) = Σ_j c_ij ψ_j(p): 1, then powers of each scaled variable.

    `coefficients`: c (shapes, 1 + s·degree); `degree` of the polynomials in the scheduling variables, scaled to −1 … 1.
    """

    effect: Effect
    coefficients: FloatArray
    degree: int = 0

    @property
    def size(self) -> int:
        """Number of amplitude coefficients."""
        return int(self.coefficients.size)

    def amplitude(self, setting: Setting, batch: Batch) -> FloatArray:
        """e (shapes, M) at the measurements of a batch."""
        return self.coefficients @ amplitude_basis(self.effect, self.degree, setting, batch).T

    def parameters(self) -> FloatArray:
        """The amplitude coefficients, then the fitted further parameters."""
        return np.concatenate([self.coefficients.ravel(), self.effect.values()])

    def with_parameters(self, values: FloatArray) -> "PlacedEffect":
        """The same effect with other parameters, ordered as `parameters` gives them."""
        amplitudes, further = values[: self.size], values[self.size :]
        effect = self.effect.with_values(further) if len(further) else self.effect
        return replace(self, effect=effect, coefficients=amplitudes.reshape(self.coefficients.shape))


def amplitude_basis(effect: Effect, degree: int, setting: Setting, batch: Batch) -> FloatArray:
    """ψ (M, 1 + s·degree), times the profile of the effect over the measurements."""
    powers = [np.ones((len(setting.points), 1)), *(setting.points**d for d in range(1, degree + 1))]
    return np.hstack(powers) * effect.profile(setting, batch)[:, None]


def placed(effect: Effect, degree: int, variables: int, amplitude: float = 0.0) -> PlacedEffect:
    """An effect with an amplitude that does not depend on p yet."""
    coefficients = np.zeros((effect.shapes, 1 + variables * degree))
    coefficients[:, 0] = amplitude
    return PlacedEffect(effect, coefficients, degree)
