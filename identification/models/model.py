"""A parameter-varying model, with the physical effects that it carries."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from identification.comparison.batch import Batch
from identification.errors import MisuseError, ShapeError
from identification.models.physical import RationalForm
from identification.models.structure import Structure
from identification.places.place import Flow, Setting
from identification.places.placed import PlacedEffect
from identification.places.simulate import Acting, followed, from_rest, simulate
from identification.scheduling import ParameterDependence, SchedulingVariable
from identification.signals import OperatingPoint

SLOPE_STEP = 1e-4


@dataclass(frozen=True, eq=False)
class LocalModel:
    """A model at one operating point: ζ (n,), its covariance P_ζ (n, n) and the variance σ_e² of e."""

    structure: RationalForm
    operating_point: OperatingPoint
    zeta: FloatArray
    covariance: FloatArray
    noise_variance: float


@dataclass(frozen=True, eq=False)
class Model:
    """A parameter-varying model ζ(p) = T(p) θ of a plant, and the physical effects that act in it or on it.

    θ (k,) with its `covariance` P_θ (k, k), None where it is not known; `noise_variance` σ_e² of e. `joint_covariance`
    of `parameters`, θ_G and those of the effects, as they were estimated together; None before that. Its coefficients,
    response and poles are those of the plant itself; `respond` and `output` hold the effects as well. `chart` Q (k, r):
    where the structure has directions that no response shows, θ_G moves along the columns of Q only, and δ = Qᵀ θ
    stands in its place.
    """

    structure: Structure
    dependence: ParameterDependence
    theta: FloatArray
    covariance: FloatArray | None
    noise_variance: float
    effects: tuple[PlacedEffect, ...] = ()
    joint_covariance: FloatArray | None = None
    chart: FloatArray | None = None

    def __post_init__(self) -> None:
        n, k = self.structure.size, self.dependence.size
        if self.dependence.coefficient_count != n:
            raise ShapeError(f"{self.dependence.coefficient_count} bases were given for {n} coefficients", "basis")
        if np.shape(self.theta) != (k,):
            raise ShapeError(f"θ has shape {np.shape(self.theta)}, this model has {k} parameters", "theta")
        if self.covariance is not None and np.shape(self.covariance) != (k, k):
            raise ShapeError(f"the covariance has shape {np.shape(self.covariance)}, it must be {(k, k)}", "covariance")

    @cached_property
    def plant_size(self) -> int:
        """k_G, the number of entries of θ that belong to G, or of δ; they come first."""
        if self.chart is not None:
            return int(self.chart.shape[1])
        return self.dependence.parameters_of(self.structure.n_plant)

    @property
    def noise_size(self) -> int:
        """k_H, the number of entries of θ that belong to H."""
        return self.dependence.size - self.dependence.parameters_of(self.structure.n_plant)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """A name for each entry of θ, or of δ."""
        if self.chart is not None:
            return tuple(f"δ{i + 1}" for i in range(self.plant_size))
        return self.dependence.parameter_names(self.structure.coefficient_names)

    @property
    def plant_parameters(self) -> FloatArray:
        """θ_G, or δ."""
        return self.theta[: self.plant_size] if self.chart is None else self.theta @ self.chart

    @property
    def plant_covariance(self) -> FloatArray:
        """The covariance of θ_G, or of δ; raises MisuseError where it is not known."""
        if self.chart is not None:
            return np.asarray(self.chart.T @ self.theta_covariance @ self.chart)
        return self.theta_covariance[: self.plant_size, : self.plant_size]

    @property
    def theta_covariance(self) -> FloatArray:
        """P_θ; raises MisuseError where it is not known."""
        if self.covariance is None:
            raise MisuseError("the model has no covariance; refine it by maximum likelihood, or state one", "model")
        return self.covariance

    def pulled(self, by_zeta: ComplexArray, points: ArrayLike) -> ComplexArray:
        """Derivatives by ζ_G (M, …, n_plant) as those by θ_G, or δ, (M, …, k_G)."""
        by_theta = self.dependence.pulled(by_zeta, points)
        return by_theta if self.chart is None else np.asarray(by_theta @ self.chart)

    def direction(self, plant: FloatArray) -> FloatArray:
        """A change of θ_G, or of δ, as one of θ (k,)."""
        return np.pad(plant, (0, self.noise_size)) if self.chart is None else np.asarray(self.chart @ plant)

    @property
    def variables(self) -> tuple[SchedulingVariable, ...]:
        """The scheduling variables with their ranges."""
        return self.dependence.variables

    def coefficients(self, points: ArrayLike) -> FloatArray:
        """ζ(p) at the operating points (M, s), as (M, n)."""
        return self.dependence.coefficients(self.theta, points)

    def frequency_response(self, points: ArrayLike, omega: FloatArray) -> ComplexArray:
        """G(p, ω) at the operating points (M, s) and ω (F,) in rad/s, as (M, F, n_y, n_u)."""
        return self.structure.response(self.coefficients(points), np.asarray(omega, dtype=np.float64))

    def response_covariance(self, points: ArrayLike, omega: FloatArray) -> FloatArray:
        """Covariance of (Re, Im) of each entry of G, as (M, F, n_y, n_u, 2, 2), to first order in P_θ."""
        gradient = self.structure.gradient(self.coefficients(points), np.asarray(omega, dtype=np.float64))
        sensitivity = self.pulled(gradient, points)
        parts = np.stack([sensitivity.real, sensitivity.imag], axis=-2)
        return np.asarray(parts @ self.plant_covariance @ np.swapaxes(parts, -1, -2))

    def poles(self, points: ArrayLike) -> ComplexArray:
        """Poles of G at the operating points (M, s), as (M, n_a)."""
        return self.structure.poles(self.coefficients(points))

    def stable(self, points: ArrayLike) -> BoolArray:
        """Whether G is stable, and H stable with a stable inverse, at the operating points (M, s), as (M,)."""
        return self.structure.stable(self.coefficients(points))

    @property
    def parameters(self) -> FloatArray:
        """θ_G, or δ, then the parameters of each effect."""
        return np.concatenate([self.plant_parameters, *(one.parameters() for one in self.effects)])

    @property
    def known_covariance(self) -> FloatArray | None:
        """The covariance of `parameters`; without effects that of θ_G serves, with effects not yet estimated None."""
        if self.joint_covariance is None and not self.effects and self.covariance is not None:
            return self.plant_covariance
        return self.joint_covariance

    def with_parameters(self, values: FloatArray) -> "Model":
        """The same model with other parameters and no joint covariance."""
        plant = self.plant_size
        theta = self.theta + self.direction(values[:plant] - self.plant_parameters)
        lengths = [len(one.parameters()) for one in self.effects]
        parts = np.split(values[plant:], np.cumsum(lengths)[:-1]) if lengths else []
        effects = tuple(one.with_parameters(part) for one, part in zip(self.effects, parts, strict=True))
        return replace(self, theta=theta, effects=effects, joint_covariance=None)

    def plus(self, effect: PlacedEffect) -> "Model":
        """The model with one effect more, not fitted yet."""
        return replace(self, effects=(*self.effects, effect), joint_covariance=None)

    def setting(self, points: ArrayLike, channels: IntArray | None = None) -> Setting:
        """ζ and its slope at the operating points (M, s), seen in `channels` (M, 2)."""
        variables = self.dependence.variables
        p = self.dependence.points(points)
        low, high = np.array([(v.minimum, v.maximum) for v in variables]).T
        half = (high - low) / 2
        steps = SLOPE_STEP * np.diag(half)[:, None]
        up, down = np.minimum(p + steps, high), np.maximum(p - steps, low)
        zeta, *ends = np.split(self.coefficients(np.concatenate([p, *up, *down])), 1 + 2 * len(half))
        lengths = np.einsum("sms->sm", up - down) / half[:, None]
        slopes = (np.array(ends[: len(half)]) - np.array(ends[len(half) :])) / lengths[..., None]
        slope = np.moveaxis(slopes, 0, -1)[:, : self.structure.n_plant]
        return Setting(self.structure, zeta, (p - low) / half - 1, slope, None, channels)

    def respond(self, batch: Batch, start: Flow | None = None) -> Flow:
        """The steady signals of a batch; see `identification.places.simulate`. Laws follow what they are told to."""
        if batch.followed is not None:
            return self.follow(batch, batch.followed)
        setting = self.setting(batch.points, batch.ports)
        return simulate(setting, self._acting(setting, batch), batch, start)

    def from_rest(self, batch: Batch) -> Flow:
        """The signals from rest for an input in their first half; see `identification.places.simulate.from_rest`."""
        setting = self.setting(batch.points)
        return from_rest(setting, self._acting(setting, batch), batch)

    def follow(self, batch: Batch, measured: ComplexArray) -> Flow:
        """The signals of a batch with the motion taken from the measured output (M, K)."""
        setting = self.setting(batch.points)
        return followed(setting, self._acting(setting, batch), batch, measured)

    def _acting(self, setting: Setting, batch: Batch) -> list[Acting]:
        return [(one.effect, one.amplitude(setting, batch)) for one in self.effects]

    def output(self, batch: Batch) -> ComplexArray:
        """The lines of the output, (M, K)."""
        return self.respond(batch).output


def require_matching(model: Model, batches: Sequence[Batch]) -> None:
    """Raises MisuseError unless the batches can be compared with the model: time domain, operating points."""
    shape = (model.structure.outputs, model.structure.inputs)
    for batch in batches:
        model.dependence.points(batch.points)
        if batch.shape != shape:
            raise MisuseError(
                f"the model has {shape[0]} outputs and {shape[1]} inputs and the measurement {batch.shape[0]} and"
                f" {batch.shape[1]}; compare data of the same channels",
                "experiments",
            )
        if shape != (1, 1) and batch.held is not None and not model.structure.is_discrete:
            raise MisuseError(
                "responses of several inputs and outputs through a held input are compared with models in discrete time"
                " only; give those of the plant itself",
                "experiments",
            )
        sampled = batch.sample_time is not None
        own = model.structure.sample_time
        if own is not None and not (sampled and abs((batch.sample_time or 0.0) / own - 1) < 1e-9):
            raise MisuseError(
                f"the model has the sample time {own} s and the measurement {batch.sample_time}; compare data of the"
                " same sampling",
                "sample_time",
            )
