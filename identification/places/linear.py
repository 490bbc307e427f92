"""Effects that act on the linear response.

On the coefficients, on the axis of frequencies, as factor, in parallel.
"""

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.place import Effect, Flow, Setting
from identification.signals import HeldInput

STEP = 1e-4


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
        column, omega = e[0][:, None], flow.batch.omega
        relative = self.slope(column, omega) / self.factor(column, omega)
        return np.asarray((relative * flow.factored)[None])


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

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (shapes, M, K)."""
        shapes = np.atleast_2d(self.shape(flow.batch.omega))[:, None, :]
        return np.asarray(shapes * flow.passing * (flow.factor if self.within else 1.0))


@dataclass(frozen=True)
class FrequencyAxis(Effect):
    """The plant answers as if all frequencies were (1 + e) times as high: Y = G((1 + e) ω) U."""

    place: ClassVar[str] = "axis of frequencies"

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (1, M, K), from central differences along the axis."""
        ends = [self.response(e[0] + step, flow.setting, flow.batch.omega, flow.held) for step in (STEP, -STEP)]
        return np.asarray(((ends[0] - ends[1]) / (2 * STEP) * flow.drive * flow.factor)[None])

    def response(self, e: FloatArray, setting: Setting, omega: FloatArray, held: HeldInput | None) -> ComplexArray:
        """G((1 + e) ω) (M, K) for e (M,), as it is seen through the hold of the input."""
        found = []
        for zeta, change in zip(setting.zeta, e, strict=True):
            stretched = None if held is None else replace(held, step=held.step / float(1 + change))
            found.append(setting.structure.plant_response(zeta, omega * (1 + change), stretched))
        return np.stack(found)


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
