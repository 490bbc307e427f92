"""A parameter-varying model that carries physical effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.models import LpvModel
from identification.places.place import Effect, Flow, Setting
from identification.places.simulate import Solver, simulate

SLOPE_STEP = 1e-4


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


@dataclass(frozen=True, eq=False)
class ExtendedModel:
    """A model ζ(p) = T(p) θ with effects; without effects it answers as the model itself.

    `covariance` of (θ_G, parameters of the effects) together, None before it has been estimated.
    """

    base: LpvModel
    effects: tuple[PlacedEffect, ...] = ()
    covariance: FloatArray | None = None

    @property
    def parameters(self) -> FloatArray:
        """θ_G, then the parameters of each effect."""
        plant = self.base.theta[: self.base.plant_size]
        return np.concatenate([plant, *(one.parameters() for one in self.effects)])

    def with_parameters(self, values: FloatArray) -> "ExtendedModel":
        """The same model with other parameters and no covariance."""
        plant = self.base.plant_size
        theta = np.concatenate([values[:plant], self.base.theta[plant:]])
        lengths = [len(one.parameters()) for one in self.effects]
        parts = np.split(values[plant:], np.cumsum(lengths)[:-1]) if lengths else []
        effects = tuple(one.with_parameters(part) for one, part in zip(self.effects, parts, strict=True))
        return ExtendedModel(replace(self.base, theta=theta), effects)

    def plus(self, effect: PlacedEffect) -> "ExtendedModel":
        """The model with one effect more, not fitted yet."""
        return ExtendedModel(self.base, (*self.effects, effect))

    def setting(self, points: ArrayLike) -> Setting:
        """ζ and its slope at the operating points (M, s)."""
        variables = self.base.dependence.variables
        p = self.base.dependence.points(points)
        low, high = np.array([(v.minimum, v.maximum) for v in variables]).T
        half = (high - low) / 2
        steps = SLOPE_STEP * np.diag(half)[:, None]
        up, down = np.minimum(p + steps, high), np.maximum(p - steps, low)
        zeta, *ends = np.split(self.base.coefficients(np.concatenate([p, *up, *down])), 1 + 2 * len(half))
        lengths = np.einsum("sms->sm", up - down) / half[:, None]
        slopes = (np.array(ends[: len(half)]) - np.array(ends[len(half) :])) / lengths[..., None]
        slope = np.moveaxis(slopes, 0, -1)[:, : self.base.structure.n_plant]
        return Setting(self.base.structure, zeta, (p - low) / half - 1, slope)

    def respond(self, batch: Batch, start: ComplexArray | None = None, solve: Solver | None = None) -> Flow:
        """The steady signals of a batch; see `identification.places.simulate`."""
        setting = self.setting(batch.points)
        acting = [(one.effect, one.amplitude(setting, batch)) for one in self.effects]
        return simulate(setting, acting, batch, start, solve)

    def output(self, batch: Batch) -> ComplexArray:
        """The lines of the output, (M, K)."""
        return self.respond(batch).output


def require_matching(model: LpvModel, batches: Sequence[Batch]) -> None:
    """Raises MisuseError unless the batches can be compared with the model: time domain, operating points."""
    for batch in batches:
        model.dependence.points(batch.points)
        sampled = batch.sample_time is not None
        own = model.structure.sample_time
        if own is not None and not (sampled and abs((batch.sample_time or 0.0) / own - 1) < 1e-9):
            raise MisuseError(
                f"the model has the sample time {own} s and the measurement {batch.sample_time}; compare data of the"
                " same sampling",
                "sample_time",
            )
