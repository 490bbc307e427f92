"""What a design is asked for."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from identification.arrays import FloatArray, finite_floats
from identification.comparison.batch import Batch
from identification.errors import MisuseError, RangeError, ShapeError
from identification.models.model import Model
from oed.decisions import Demand
from oed.limits.limit import Limit, shares_of
from oed.spectra.family import SpectrumFamily

SYMMETRIC = 1e-9


class AccuracyTarget(Protocol):
    """How accurately θ is to be known; effects in the model are estimated with it."""

    def matrices(self, model: Model) -> FloatArray:
        """Matrices R_j (J, k, k), block diagonal in θ_G and θ_H, with P_θ⁻¹ ⪰ R_j for all j [Ghosh2018, (15), (16)]."""


@runtime_checkable
class DecisionTarget(Protocol):
    """What the experiments are to decide about effects."""

    def demands(self, model: Model, reference: Sequence[Batch], measured: bool) -> tuple[Demand, ...]:
        """The hypotheses that decide it, with the accuracy that they need.

        `reference`: experiments that were done (`measured`), or such as the spectrum family would do.
        """


Target = AccuracyTarget | DecisionTarget


@dataclass(frozen=True, eq=False)
class DesignProblem:
    """Least input energy for stated accuracy [Ghosh2018, (17)].

    `model`: what is known of the plant (θ and σ_e² or their estimates), with effects or without; `points` (M, s): the
    operating points to choose from, or with `box` the starting grid of a search over the whole range of the scheduling
    variables; `samples`: N_p of each local experiment; `caps` (M,): the most energy α_m at each point, infinite for
    none (Remark 5); `prior_information` (k, k): P⁻¹ of what earlier experiments told (Section 4), in the order θ_G,
    effects, θ_H; in its place `prior_experiments`, which also tell about effects that are not in the model; `band` in
    rad/s; `sample_time` of the input in seconds, needed for models in continuous time; `tolerance`: relative gap to be
    certified; `plant_limits`: what the plant may not do, each bound in itself (`oed.limits`).
    """

    model: Model
    points: FloatArray
    targets: tuple[Target, ...]
    family: SpectrumFamily
    samples: int
    caps: FloatArray | None = None
    prior_information: FloatArray | None = None
    prior_experiments: tuple[Batch, ...] = ()
    band: tuple[float, float] | None = None
    sample_time: float | None = None
    tolerance: float = 1e-4
    box: bool = False
    plant_limits: tuple[Limit, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", self.model.dependence.points(self.points))
        if len(self.points) == 0 or len(np.unique(self.points, axis=0)) < len(self.points):
            raise ShapeError("give at least one operating point, and each of them once", "points")
        if not self.targets:
            raise MisuseError("no accuracy target is given; say how accurate the model must become", "targets")
        if self.samples < 1:
            raise RangeError(f"the number of samples is {self.samples}; it must be positive", "samples")
        if not 0 < self.tolerance < 1:
            raise RangeError(f"the tolerance is {self.tolerance}; choose it between 0 and 1", "tolerance")
        if not (np.isfinite(self.model.noise_variance) and self.model.noise_variance > 0):
            raise RangeError(
                f"the noise variance is {self.model.noise_variance}; without noise any experiment would be accurate"
                " enough, state how large it is",
                "noise_variance",
            )
        if self.box and self.plant_limits:
            raise MisuseError("limits of the plant belong to the points of a grid; give a grid", "limits")
        self._check_caps()
        self._check_prior()
        self._check_band()

    @property
    def step(self) -> float:
        """The sample time of the input in seconds."""
        return self.model.structure.sample_time or self.sample_time or 0.0

    @property
    def limits(self) -> FloatArray:
        """The energy caps α (M,), infinite where there is none."""
        return np.full(len(self.points), np.inf) if self.caps is None else self.caps

    def share(self, omega: FloatArray) -> FloatArray:
        """The share (L, M, F) of each of the plant's limits that a mean square of one at ω (F,) in rad/s takes."""
        return shares_of(self.plant_limits, self.model, self.points, omega)

    @property
    def size(self) -> int:
        """Number of parameters of the model: θ_G, those of its effects, θ_H."""
        return len(self.model.parameters) + self.model.noise_size

    @property
    def prior(self) -> FloatArray:
        """The prior information (k, k) about the model itself, zero when there is none."""
        return np.zeros((self.size, self.size)) if self.prior_information is None else self.prior_information

    def _check_caps(self) -> None:
        if self.caps is None:
            return
        object.__setattr__(self, "caps", np.array(self.caps, dtype=np.float64))
        if self.box:
            raise MisuseError("energy caps belong to the points of a grid; leave them out or give a grid", "caps")
        if self.limits.shape != (len(self.points),):
            raise ShapeError(f"{self.limits.size} energy caps were given for {len(self.points)} points", "caps")
        if not np.all(self.limits > 0):
            raise RangeError("an energy cap is not positive; exclude the operating point instead", "caps")

    def _check_prior(self) -> None:
        if self.prior_information is None:
            return
        if self.prior_experiments:
            raise MisuseError("prior information and prior experiments would count twice", "prior_information")
        prior, k = finite_floats(self.prior_information, "prior_information"), self.size
        field = "prior_information"
        if prior.shape != (k, k):
            raise ShapeError(f"the prior information has shape {prior.shape}, it must be {(k, k)}", field)
        size = np.sqrt(np.maximum(np.diagonal(prior), 0.0))
        scale = np.outer(*(np.where(size > 0, size, 1.0),) * 2)
        if np.any(abs(prior - prior.T) > SYMMETRIC * scale):
            raise RangeError("the prior information is not symmetric; give the inverse of a covariance", field)
        if np.linalg.eigvalsh((prior + prior.T) / 2 / scale)[0] < -SYMMETRIC:
            raise RangeError("the prior information is not positive semidefinite", field)
        object.__setattr__(self, field, (prior + prior.T) / 2)

    def _check_band(self) -> None:
        if self.model.structure.sample_time is None and not (self.sample_time and self.sample_time > 0):
            raise MisuseError("give the sample time of the input; the model is in continuous time", "sample_time")
        if self.band is not None and not 0 <= self.band[0] <= self.band[1] <= np.pi / self.step * (1 + 1e-9):
            raise RangeError(
                f"the band {self.band} rad/s must rise and lie between 0 and {np.pi / self.step:.6g} rad/s", "band"
            )
