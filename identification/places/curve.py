"""A curve of no stated form at the places where it can act."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.places.friction import sign
from identification.places.linear import Coefficient
from identification.places.nonlinear import Actuator, Feedback, Sensor
from identification.places.place import Setting
from identification.places.spline import Spline


@dataclass(frozen=True, eq=False)
class Curve:
    """f(x) = c_0 h + c_1 h sign x + Σ c_i φ_i(x), with c_0 where `constant`, c_1 where `jump`, φ the `spline`.

    `coefficients` (shapes,), or (shapes, M) where x is (M, L) or (M,); h is as high as the smoothest φ at its knots.
    """

    spline: Spline
    coefficients: FloatArray
    constant: bool
    jump: bool

    def __call__(self, x: FloatArray) -> FloatArray:
        """f, as large as x; the sign of a periodic signal as its mean over each step."""
        first = int(self.constant) + int(self.jump)
        found = self.spline.combined(self.coefficients[first:], x)
        if self.constant:
            found = found + self.spline.height * self._column(0, x)
        if self.jump:
            found = found + self.spline.height * self._column(first - 1, x) * sign(x)
        return found

    def each(self, x: FloatArray) -> FloatArray:
        """The shapes (shapes, n) at single values x (n,), each for a coefficient of one; the sign as it is."""
        found = [self.spline.height * np.ones(len(x))] if self.constant else []
        found += [self.spline.height * np.sign(x)] if self.jump else []
        return np.stack([*found, *self.spline(x)])

    def _column(self, i: int, x: FloatArray) -> FloatArray:
        c = np.asarray(self.coefficients[i])
        return c[:, None] if c.ndim and x.ndim > 1 else c


@dataclass(frozen=True, eq=False)
class CurveForce(Feedback):
    """A force f(q)."""

    oversampling: ClassVar[int] = 4

    law: Curve | None = None

    def force(self, x: FloatArray, velocity: FloatArray) -> FloatArray:
        """f(q)."""
        assert self.law is not None
        return self.law(x if self.on_displacement else velocity)


@dataclass(frozen=True, eq=False)
class FlowCurveForce(CurveForce):
    """A force f(q̇), which may jump where the motion turns."""

    oversampling: ClassVar[int] = 8
    on_displacement: ClassVar[bool] = False


@dataclass(frozen=True, eq=False)
class CurveActuator(Actuator):
    """u + f(u)."""

    law: Curve

    def shape(self, u: FloatArray) -> FloatArray:
        """f(u)."""
        return self.law(u)


@dataclass(frozen=True, eq=False)
class CurveSensor(Sensor):
    """y + f(y)."""

    law: Curve

    def shape(self, y: FloatArray) -> FloatArray:
        """f(y)."""
        return self.law(y)


@dataclass(frozen=True, eq=False)
class CurveCoefficient(Coefficient):
    """ζ_i + f(p̃) of one scheduling variable, i = `coefficient`."""

    law: Curve
    coefficient: int
    variable: int

    def direction(self, setting: Setting) -> FloatArray:
        """f for the coefficient, zero for the others."""
        chosen = np.arange(setting.structure.n_plant) == self.coefficient
        return np.asarray(self.law(setting.points[:, self.variable])[:, None] * chosen)
