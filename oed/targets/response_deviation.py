"""Standard deviation of the frequency response at chosen operating points in a band."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError
from identification.models.model import Model


@dataclass(frozen=True)
class ResponseDeviation:
    """Standard deviation δ of the frequency response G(p, ω) in every direction of the complex plane.

        P_θ⁻¹ ⪰ R = V Vᵀ/δ²,   V = (Re g, Im g),  g = T_G(p)ᵀ ∂G/∂ζ_G   ⇔   cov(Re G, Im G) = Vᵀ P_θ V ⪯ δ² I

    at `count` frequencies of the band, spread logarithmically, at each operating point. The variance
    E|G(θ̂) − G(θ⁰)|² is then at most 2 δ², and the gain known to ± 1.96 δ with 95 % probability. With `relative`,
    δ is that share of |G(p, ω)|.
    """

    kind: ClassVar[str] = "response_deviation"

    operating_points: Annotated[tuple[tuple[float, ...], ...], "one row of scheduling variables a point"]
    minimum_rad_per_second: Annotated[float, "lower edge of the band, rad/s"]
    maximum_rad_per_second: Annotated[float, "upper edge of the band, rad/s"]
    standard_deviation: Annotated[float, "δ, in the unit of G, or as a share of |G|"]
    relative: Annotated[bool, "the standard deviation is a share of |G|"] = True
    count: Annotated[int, "number of frequencies in the band"] = 20

    def matrices(self, model: Model) -> FloatArray:
        """R_j (J, k, k), one per operating point and frequency; raises RangeError."""
        self._check(model)
        lower = self.minimum_rad_per_second
        omega = np.geomspace(lower, self.maximum_rad_per_second, self.count) if lower > 0 else self._linear()
        points = np.array(self.operating_points, ndmin=2)
        gradient = model.structure.plant_gradient(model.coefficients(points), omega)
        g = model.pulled(np.swapaxes(gradient, 1, 2), points)
        gain = abs(model.frequency_response(points, omega)[..., 0, 0]) if self.relative else 1.0
        delta = np.broadcast_to(self.standard_deviation * gain, g.shape[:2]).reshape(-1, 1, 1)
        g = np.pad(g.reshape(-1, g.shape[-1]), ((0, 0), (0, model.noise_size)))
        if np.any(delta <= 0):
            raise RangeError("the response is zero at a frequency of the band; use an absolute deviation", "relative")
        v = np.stack([g.real, g.imag], axis=-1) / delta
        return np.asarray(v @ np.swapaxes(v, 1, 2))

    def _linear(self) -> FloatArray:
        return np.linspace(self.minimum_rad_per_second, self.maximum_rad_per_second, self.count)

    def _check(self, model: Model) -> None:
        if not (self.standard_deviation > 0 and np.isfinite(self.standard_deviation)):
            raise RangeError("the standard deviation must be positive", "standard_deviation")
        if not 0 <= self.minimum_rad_per_second <= self.maximum_rad_per_second:
            raise RangeError("the band must rise, from zero or more", "minimum_rad_per_second")
        if not 1 <= self.count <= 1000:
            raise RangeError("the number of frequencies must lie between 1 and 1000", "count")
        step = model.structure.sample_time
        if step is not None and self.maximum_rad_per_second > np.pi / step * (1 + 1e-9):
            raise RangeError(
                f"the band ends above the Nyquist frequency {np.pi / step:.6g} rad/s", "maximum_rad_per_second"
            )

    @classmethod
    def example(cls, model: Model) -> "ResponseDeviation":
        """Five per cent in the middle of the range, for the conformance tests."""
        middle = tuple((v.minimum + v.maximum) / 2 for v in model.dependence.variables)
        return cls((middle,), 0.05, 1.0, 0.05, count=5)
