"""An effect with its amplitude over the scheduling variables: what a model carries."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.comparison.batch import Batch
from identification.places.place import Effect, Setting
from identification.places.ports import EVERYWHERE, Port


@dataclass(frozen=True, eq=False)
class PlacedEffect:
    """An effect in a model with its amplitude e_i(p) = Σ_j c_ij ψ_j(p): 1, then powers of each scaled variable.

    `coefficients`: c (shapes, 1 + s·degree); `degree` of the polynomials in the scheduling variables, scaled to −1 … 1.
    `port`: on which inputs and outputs it acts.
    """

    effect: Effect
    coefficients: FloatArray
    degree: int = 0
    port: Port = EVERYWHERE

    @property
    def size(self) -> int:
        """Number of amplitude coefficients."""
        return int(self.coefficients.size)

    def amplitude(self, setting: Setting, batch: Batch) -> FloatArray:
        """e (shapes, M) at the measurements of a batch."""
        return self.coefficients @ self.basis(setting, batch).T

    def basis(self, setting: Setting, batch: Batch) -> FloatArray:
        """ψ (M, 1 + s·degree), times the profile of the effect over the measurements, zero where it does not act."""
        powers = [np.ones((len(setting.points), 1)), *(setting.points**d for d in range(1, self.degree + 1))]
        acts = self.port.acts(setting.channels, len(setting.points))
        return np.hstack(powers) * (acts * self.effect.profile(setting, batch))[:, None]

    def parameters(self) -> FloatArray:
        """The amplitude coefficients, then the fitted further parameters."""
        return np.concatenate([self.coefficients.ravel(), self.effect.values()])

    def with_parameters(self, values: FloatArray) -> "PlacedEffect":
        """The same effect with other parameters, ordered as `parameters` gives them."""
        amplitudes, further = values[: self.size], values[self.size :]
        effect = self.effect.with_values(further) if len(further) else self.effect
        return replace(self, effect=effect, coefficients=amplitudes.reshape(self.coefficients.shape))


def placed(
    effect: Effect, degree: int, variables: int, amplitude: float = 0.0, port: Port = EVERYWHERE
) -> PlacedEffect:
    """An effect with an amplitude that does not depend on p yet."""
    coefficients = np.zeros((effect.shapes, 1 + variables * degree))
    coefficients[:, 0] = amplitude
    return PlacedEffect(effect, coefficients, degree, port)
