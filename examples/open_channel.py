"""A uniform open channel between two gates: water levels from discharges, by the linearised Saint-Venant equations."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from identification.arrays import ComplexArray, FloatArray
from identification.errors import RangeError
from identification.signals import FrequencyResponse

GRAVITY = 9.81


@dataclass(frozen=True)
class OpenChannel:
    """A trapezoidal channel in uniform flow, its width, slope and roughness the same everywhere.

        B₀ ∂h/∂t + ∂q/∂x = 0
        ∂q/∂t + 2V₀ ∂q/∂x + (c₀² − V₀²) B₀ ∂h/∂x − β q − γ h = 0
        β = −2 g S/V₀,   γ = g S B₀ (10/3 − (4A₀/(3B₀P₀)) ∂P/∂y),   c₀² = g A₀/B₀                [Litrico2009]

    for small deviations q of discharge and h of depth from uniform flow with discharge Q₀, depth y₀ by Manning's
    formula Q₀ = K A₀ (A₀/P₀)^{2/3} √S, wetted area A₀ and perimeter P₀, surface width B₀ and velocity V₀ = Q₀/A₀ < c₀.
    Inputs: the discharge q_e that enters at x = 0 and q_s that leaves at x = L, in m³/s; output: h at x, in m.

    The default length puts the nine positions of [Kergus2019, Fig. 3] symmetrically; the paper states Q₀ = 1400 m³/s
    but no cross-section, slope or roughness, so those here are this example's own: those of a large canal. With less
    slope and friction the waves run to and fro more often: more modes below 0.05 rad/s than ten states can have.
    """

    length: float = 15500.0
    discharge: float = 1400.0
    bottom_width: float = 100.0
    side_slope: float = 1.5
    bed_slope: float = 2e-4
    strickler: float = 40.0

    @cached_property
    def depth(self) -> float:
        """y₀ in m."""
        return float(brentq(lambda y: self.normal_discharge(y) - self.discharge, 1e-3, 1e3, xtol=1e-13))

    def normal_discharge(self, depth: float) -> float:
        """The discharge of uniform flow at a depth, m³/s."""
        area, perimeter = float(self.area(depth)), float(self.perimeter(depth))
        return self.strickler * area * float((area / perimeter) ** (2 / 3) * np.sqrt(self.bed_slope))

    def area(self, depth: ArrayLike) -> FloatArray:
        """Wetted area at a depth, m²."""
        y = np.asarray(depth, dtype=np.float64)
        return np.asarray((self.bottom_width + self.side_slope * y) * y)

    def perimeter(self, depth: ArrayLike) -> FloatArray:
        """Wetted perimeter at a depth, m."""
        return np.asarray(self.bottom_width + 2 * np.asarray(depth) * np.sqrt(1 + self.side_slope**2))

    @cached_property
    def surface_width(self) -> float:
        """B₀ in m."""
        return self.bottom_width + 2 * self.side_slope * self.depth

    @cached_property
    def velocity(self) -> float:
        """V₀ in m/s."""
        return self.discharge / float(self.area(self.depth))

    @cached_property
    def celerity(self) -> float:
        """c₀, the speed of waves on still water of this depth, in m/s; raises RangeError unless above V₀."""
        celerity = float(np.sqrt(GRAVITY * self.area(self.depth) / self.surface_width))
        if celerity <= self.velocity:
            raise RangeError(
                f"the flow is not subcritical: velocity {self.velocity:.3g} m/s, celerity {celerity:.3g} m/s",
                "bed_slope",
            )
        return celerity

    @cached_property
    def friction(self) -> tuple[float, float]:
        """β in 1/s and γ in m/s²."""
        widening = 2 * np.sqrt(1 + self.side_slope**2)
        hydraulic = float(self.area(self.depth) / self.perimeter(self.depth))
        gamma = GRAVITY * self.bed_slope * (10 / 3 * self.surface_width - 4 / 3 * hydraulic * widening)
        return -2 * GRAVITY * self.bed_slope / self.velocity, float(gamma)

    def exponents(self, s: ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """λ₁(s) and λ₂(s) in 1/m, of the waves e^{λx}, the real part of λ₁ being the larger.

        (c₀² − V₀²) B₀ λ² − (2V₀B₀s + γ) λ − (s − β) B₀ s = 0
        """
        laplace = np.asarray(s, dtype=np.complex128)
        beta, gamma = self.friction
        leading = (self.celerity**2 - self.velocity**2) * self.surface_width
        middle = 2 * self.velocity * self.surface_width * laplace + gamma
        root = np.sqrt(middle**2 + 4 * leading * self.surface_width * laplace * (laplace - beta))
        root = np.where(root.real < 0, -root, root)
        return (middle + root) / (2 * leading), (middle - root) / (2 * leading)

    def delays(self, position: float) -> tuple[float, float]:
        """τ_e = x/(c₀ + V₀) and τ_s = (L − x)/(c₀ − V₀) in s: how long the first wave takes from either end."""
        return position / (self.celerity + self.velocity), (self.length - position) / (self.celerity - self.velocity)

    def response(self, position: float, omega: ArrayLike, without_delays: bool = False) -> ComplexArray:
        """[G_e, G_s] from (q_e, q_s) to h at x, at ω (F,) in rad/s, ω > 0, as (F, 1, 2), m/(m³/s).

            G_e = (λ₁ e^{λ₂L + λ₁x} − λ₂ e^{λ₁L + λ₂x}) / (B₀ s (e^{λ₁L} − e^{λ₂L}))
            G_s = −(λ₁ e^{λ₁x} − λ₂ e^{λ₂x}) / (B₀ s (e^{λ₁L} − e^{λ₂L}))                  [Kergus2019, Section IV.B]

        `without_delays` multiplies by e^{τ_e s} and e^{τ_s s}. G_s has a minus that the paper lacks: what leaves lowers
        the level. Raises RangeError for a position outside the channel or ω ≤ 0, where the channel integrates.
        """
        w = np.asarray(omega, dtype=np.float64)
        if not 0 <= position <= self.length:
            raise RangeError(f"x = {position} m lies outside the channel of {self.length} m", "position")
        if np.any(w <= 0):
            raise RangeError("the channel integrates: give frequencies above zero", "frequencies")
        s = 1j * w
        first, second = self.exponents(s)
        below = self.surface_width * s * (1 - np.exp((second - first) * self.length))
        entering = first * np.exp(second * self.length + first * (position - self.length))
        entering = (entering - second * np.exp(second * position)) / below
        rest = second * np.exp(second * position - first * self.length)
        leaving = (rest - first * np.exp(first * (position - self.length))) / below
        pair = np.stack([entering, leaving], axis=-1)
        if without_delays:
            pair = pair * np.exp(s[:, None] * np.array(self.delays(position)))
        return np.asarray(pair[:, None, :])


MEASURED = (100.0, 3925.0, 7750.0, 11575.0, 15400.0)
BETWEEN = (2013.0, 5837.0, 9663.0, 13487.0)
FREQUENCIES = np.linspace(1e-4, 5e-2, 250)


def delay_free_responses(
    channel: OpenChannel, positions: tuple[float, ...] = MEASURED, omega: FloatArray = FREQUENCIES
) -> tuple[FrequencyResponse, ...]:
    """The delay-free frequency responses at some positions, by default those of [Kergus2019, (30)]."""
    return tuple(FrequencyResponse(omega, channel.response(x, omega, True), (x,)) for x in positions)
