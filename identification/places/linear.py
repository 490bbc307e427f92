"""Effects that act on the linear response.

On the coefficients, as factor, in parallel.
"""

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Self, TypeVar

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.models.structure import Structure
from identification.places.place import Effect, Flow, Setting

SMALLEST = 0.02

Here = TypeVar("Here", bound=Effect)


def each_point(effect: Here, points: FloatArray, compute: Callable[[Here, slice], ComplexArray]) -> ComplexArray:
    """What `compute` gives (…, M, K) for an effect that differs between the scaled operating points (M, s)."""
    found = effect.at(points)
    if len(found) == 1:
        return compute(found[0], slice(None))
    return np.concatenate([compute(one, slice(m, m + 1)) for m, one in enumerate(found)], axis=-2)


@dataclass(frozen=True)
class Factor(Effect):
    """Multiplies the response of the plant: Y = (1 + e s(ω)) G U, or another factor that is 1 at e = 0."""

    place: ClassVar[str] = "multiplies the linear response"

    @abstractmethod
    def shape(self, omega: FloatArray) -> ComplexArray:
        """s(ω) (K,): the derivative of the factor by e at e = 0."""

    def factor(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """The factor (…, K) for e (…, 1)."""
        return np.asarray(1 + e * self.shape(omega))

    def slope(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """∂factor/∂e (…, K)."""
        return np.broadcast_to(self.shape(omega), (*e.shape[:-1], len(omega)))

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K)."""
        points, omega = flow.setting.points, flow.batch.omega

        def relative(one: Self, rows: slice) -> ComplexArray:
            column = e[0][rows, None]
            return np.asarray(one.slope(column, omega) / one.factor(column, omega))

        return np.asarray((each_point(self, points, relative) * flow.factored)[None])

    def factor_at(self, e: FloatArray, points: FloatArray, omega: FloatArray) -> ComplexArray:
        """The factor (M, K) for e (shapes, M) at the scaled operating points (M, s)."""
        return each_point(self, points, lambda one, rows: one.factor(e[0][rows, None], omega))


@dataclass(frozen=True)
class Parallel(Effect):
    """Adds to the response of the plant: Y = (G + e s(ω)) U.

    `within`: it is a part of the plant, that is seen through the same filters and delays, and not a path beside them.
    """

    place: ClassVar[str] = "added to the linear response"
    within: ClassVar[bool] = False

    @abstractmethod
    def shape(self, omega: FloatArray) -> ComplexArray:
        """s(ω) (K,), or (shapes, K) for several amplitudes."""

    def response(self, e: FloatArray, omega: FloatArray) -> ComplexArray:
        """Σ e_i s_i(ω) (M, K) for e (shapes, M)."""
        return np.asarray(e.T @ np.atleast_2d(self.shape(omega)))

    def response_at(self, e: FloatArray, points: FloatArray, omega: FloatArray) -> ComplexArray:
        """The response (M, K) for e (shapes, M) at the scaled operating points (M, s)."""
        return each_point(self, points, lambda one, rows: one.response(e[:, rows], omega))

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (shapes, M, K)."""
        omega = flow.batch.omega
        shapes = each_point(self, flow.setting.points, lambda one, _: np.atleast_2d(one.shape(omega))[:, None, :])
        return np.asarray(shapes * flow.passing * (flow.factor if self.within else 1.0))


@dataclass(frozen=True)
class Coefficient(Effect):
    """Changes the scheduled coefficients: ζ(p) = T(p) θ + e d(p)."""

    place: ClassVar[str] = "scheduled coefficient"

    @abstractmethod
    def direction(self, setting: Setting) -> FloatArray:
        """d (M, n_plant) at the operating points of the batch."""

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K)."""
        return np.asarray(np.einsum("mnk,mn->mk", flow.by_coefficients, self.direction(flow.setting))[None])


@dataclass(frozen=True)
class Divisor(Coefficient):
    """Divides coefficients: ζ_i(p) = (T(p) θ)_i/(1 + e d(p)) for those that are `divided`."""

    @abstractmethod
    def divided(self, structure: Structure) -> BoolArray:
        """Which coefficients of the plant, (n_plant,)."""

    def divisor(self, e: FloatArray, structure: Structure) -> FloatArray:
        """What they are divided by, (M, n_plant), for e d(p) (M,): never near zero."""
        chosen = self.divided(structure)
        return np.where(chosen, np.maximum(1 + e[:, None], SMALLEST), 1.0)

    def direction(self, setting: Setting) -> FloatArray:
        """−ζ_i of those that are divided: ∂ζ_i/∂e times the divisor."""
        chosen = self.divided(setting.structure)
        return np.asarray(-setting.zeta[:, : len(chosen)] * chosen)
