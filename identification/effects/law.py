"""The missing law itself, where no effect of the library has its shape."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.places.curve import (
    Curve,
    CurveActuator,
    CurveCoefficient,
    CurveForce,
    CurveSensor,
    FlowCurveForce,
)
from identification.places.motion import motions
from identification.places.place import Effect, Flow
from identification.places.spline import spline, spread_knots

Over = Literal["displacement", "flow", "input", "output", "scheduling"]
KNOTS, FEWEST_POINTS, MOST_POINTS = 12, 5, 8
LOOSE = 30.0
THINNED = 20_000


@dataclass(frozen=True)
class Law(Effect):
    """A static curve f over the displacement q, the flow q̇, the input u, the output y, or a coefficient over p.

        x = G (u − f(q)),   x = G (u − f(q̇)),   u + f(u),   y + f(y),   ζ_i(p) + f(p̃)
        f = e_0 h + e_1 h sign q̇ + Σ e_i φ_i,   e_i ~ N(0, `size`²)

    `over` one of these; φ natural cubic splines over `knots` beyond straight lines, which the plant has already; e_0
    not over p, e_1 over the flow only, where friction jumps. The penalty makes the curve as smooth as the data allow.
    `order` and `driven` say which motion q is, `coefficient` i and `variable` what a curve over p changes
    [GreenSilverman1994, Section 2.1] [Ruppert2003, Section 4.9].
    """

    kind: ClassVar[str] = "law"
    title: ClassVar[str] = "unknown law, as a curve"
    place: ClassVar[str] = "a curve of a signal or of p"
    unit: ClassVar[str] = "unit of what the curve adds, for each shape"
    source: ClassVar[str] = "[Ruppert2003, Section 4.9]"
    unseen: ClassVar[str] = "invisible in this experiment: the signals, or the operating points, show no curve"

    over: Over = "displacement"
    knots: tuple[float, ...] = (-1.0, -0.5, 0.5, 1.0)
    size: float = 1.0
    order: int = 0
    driven: bool = False
    coefficient: int = 0
    variable: int = 0

    @property
    def on_signals(self) -> bool:
        """Whether it is a curve of a signal, and not of p."""
        return self.over != "scheduling"

    @property
    def shapes(self) -> int:
        """Constant and jump where it has them, then one for each φ."""
        return len(self.knots) - 2 + int(self.on_signals) + int(self.over == "flow")

    def describe(self) -> str:
        """What the curve is over."""
        if self.over == "scheduling":
            return f"of coefficient {self.coefficient + 1} over scheduling variable {self.variable + 1}"
        motion = " of the input" if self.driven else ("", ", the integral of the output", ", its second integral")
        where = motion if isinstance(motion, str) else motion[self.order] if self.over == "displacement" else ""
        return f"over the {self.over}{where}"

    def precision(self) -> FloatArray:
        """1/size², that of the constant next to nothing."""
        found = np.full(self.shapes, self.size**-2)
        found[: int(self.on_signals)] /= LOOSE**2
        return found

    def curve(self, e: FloatArray) -> Curve:
        """f at the amplitudes (shapes,) or (shapes, M)."""
        return Curve(spline(self.knots), e, self.on_signals, self.over == "flow")

    def composed(self, e: FloatArray) -> tuple[Effect, FloatArray]:
        """The curve in its place."""
        return self._placed(self.curve(e)), np.ones((1, e.shape[1]))

    def _placed(self, law: Curve) -> Effect:
        if self.over == "input":
            return CurveActuator(law)
        if self.over == "output":
            return CurveSensor(law)
        if self.over == "scheduling":
            return CurveCoefficient(law, self.coefficient, self.variable)
        return (FlowCurveForce if self.over == "flow" else CurveForce)(self.order, self.driven, law)

    def tangent(self, e: FloatArray, flow: Flow) -> ComplexArray:
        """∂Y/∂e (shapes, M, K)."""
        one = np.ones((1, e.shape[1]))
        return np.concatenate([self._placed(self.curve(shape)).tangent(one, flow) for shape in np.eye(self.shapes)])

    def variants_over(self, flows: Sequence[Flow]) -> list[Self]:
        """Every place, with knots where the signals of all batches are, or the operating points."""
        found = self._over_points(np.concatenate([flow.setting.points for flow in flows]), flows[0])
        return found if any(flow.batch.signals is None for flow in flows) else [*self._over_signals(flows), *found]

    def variants(self, flow: Flow) -> list[Self]:
        """Every place, for one batch."""
        return self.variants_over([flow])

    def _over_signals(self, flows: Sequence[Flow]) -> list[Self]:
        found: list[Self] = []
        for order, driven in motions(flows[0].batch.channels):
            for over in ("displacement", "flow"):
                same = any(one.order - (one.over == "flow") == order - (over == "flow") for one in found)
                if not same:
                    found.append(replace(self, over=over, order=order, driven=driven))
        found += [replace(self, over="input"), replace(self, over="output")]
        placed = [replace(one, knots=spread_knots(one.argument(flows), KNOTS)) for one in found]
        return [one for one in placed if one.knots]

    def argument(self, flows: Sequence[Flow]) -> FloatArray:
        """Values (n,) of what a curve of a signal is over, some of them where there are many."""
        every = np.concatenate([self._signal(flow).ravel() for flow in flows])
        return every[:: len(every) // THINNED + 1]

    def _signal(self, flow: Flow) -> FloatArray:
        if self.over == "input":
            return flow.signals
        if self.over == "output":
            return flow.linear_signal
        return flow.motion(self.order, self.driven, 1)[self.over == "flow"]

    def _over_points(self, points: FloatArray, flow: Flow) -> list[Self]:
        structure = flow.setting.structure
        if not all(len(group.entries) == 1 for group in structure.groups):
            return []
        found = []
        for s, column in enumerate(points.T):
            values = np.unique(column)
            if len(values) >= FEWEST_POINTS:
                shares = np.linspace(0, 1, min(len(values), MOST_POINTS))
                knots = tuple(map(float, np.quantile(values, shares)))
                one = replace(self, over="scheduling", knots=knots, variable=s)
                found += [replace(one, coefficient=i) for i in range(structure.n_plant)]
        return found
