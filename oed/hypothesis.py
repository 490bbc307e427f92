"""A model around which experiments are weighed, and what they tell about its open parameters."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import EXCITED, Batch
from identification.errors import MisuseError
from identification.extension.rows import Rows, effect_tangents, plant_tangents
from identification.models.model import Model
from identification.places.place import Effect, Flow
from identification.places.placed import PlacedEffect
from oed.information import sensitivity


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A model with its open parameters: θ_G, those of its effects, and at most one more.

        with a `suspected` effect its amplitudes e, at zero;    with a `rival` c in Y + c (Y_rival − Y), at zero

    1/Var(c) is the noncentrality with which the rival is told from the model, all other parameters free: how far apart
    the two stay when the model does what it can to imitate the rival [AtkinsonFedorov1975, Section 2].
    """

    model: Model
    suspected: PlacedEffect | None = None
    rival: Model | None = None

    @cached_property
    def size(self) -> int:
        """Number of open parameters."""
        extra = self.suspected.size if self.suspected is not None else int(self.rival is not None)
        return len(self.model.parameters) + extra

    @property
    def effects(self) -> tuple[Effect, ...]:
        """All effects that play a part."""
        placed = [*self.model.effects, *(self.rival.effects if self.rival else ())]
        return tuple(one.effect for one in (*placed, *([self.suspected] if self.suspected else ())))

    def tangents(self, batches: Sequence[Batch]) -> FloatArray:
        """∂Ŷ by the open parameters, whitened, (size, R)."""
        rows = Rows(tuple(batches))
        flows = [self.model.respond(batch) for batch in batches]
        for effect, flow in product(self.effects, flows):
            _require_shown(effect, flow)
        parts = [plant_tangents(self.model, rows, flows)]
        for one in self.model.effects:
            by_logarithm = effect_tangents(one, rows, flows)
            by_logarithm[one.size :] /= one.effect.values()[:, None]
            parts.append(by_logarithm)
        if self.suspected is not None:
            parts.append(effect_tangents(self.suspected, rows, flows, further=False))
        if self.rival is not None:
            pairs = zip(batches, flows, strict=True)
            parts.append(rows.whiten([(self.rival.output(batch) - flow.output)[None] for batch, flow in pairs]))
        return np.concatenate(parts)

    def by_record(self, batch: Batch) -> FloatArray:
        """The information of each record of a batch, (M, size, size)."""
        tangents = self.tangents([batch]).reshape(self.size, len(batch.points), -1)
        return np.asarray(np.einsum("imr,jmr->mij", tangents, tangents, optimize=True))

    def sensitivity(self, points: ArrayLike, omega: FloatArray) -> ComplexArray:
        """a (M, F, size) with the information Re(a a*) of one unit of input energy at points (M, s) and ω (F,)."""
        if not self.effects:
            return sensitivity(self.model, points, omega)
        if any(effect.needs_records for effect in self.effects):
            raise MisuseError(
                "what effects on signals show depends on the signal, not on its spectrum alone; choose candidate"
                " multisines",
                "family",
            )
        batch = response_batch(self.model, points, omega)
        return np.stack([batch.complex_residual(row) for row in self.tangents([batch])], axis=-1)


def _require_shown(effect: Effect, flow: Flow) -> None:
    """Raises MisuseError for an effect that lies in how or when was measured, or that a response cannot show."""
    if effect.needs_records and flow.batch.signals is None:
        raise MisuseError(
            f"{effect.title} shows only in periodic records; name no frequency responses as earlier experiments",
            "effect",
        )
    if effect.of_measurements or not effect.judgeable(flow):
        raise MisuseError(
            f"{effect.title} lies in how or when was measured, not in the plant: no experiment can be designed for it",
            "effect",
        )


def response_batch(model: Model, points: ArrayLike, omega: FloatArray) -> Batch:
    """Measurements of one unit of input energy at every frequency of every operating point, outputs zero."""
    p = model.dependence.points(points)
    nothing = np.zeros((len(p), len(omega)), dtype=np.complex128)
    batch = Batch(
        points=p,
        omega=omega,
        inputs=nothing + 1,
        outputs=nothing,
        variances=np.ones(nothing.shape),
        classes=np.full(nothing.shape, EXCITED),
        members=np.arange(len(p)),
        sample_time=model.structure.sample_time,
    )
    return replace(batch, variances=noise_variances(model, batch, 1))


def noise_variances(model: Model, batch: Batch, samples: int) -> FloatArray:
    """E|n|² (M, K) of the lines of a period of `samples`: |H|² σ_e²/samples, twice that at real lines."""
    response = model.structure.noise_response(model.coefficients(batch.points), batch.omega)
    return np.asarray(model.noise_variance / samples * abs(response) ** 2 * np.where(batch.real, 2.0, 1.0))


def sample_noise_variance(batch: Batch) -> float:
    """σ² of white noise on a sample, from periodic records: that of the mean lines times samples and periods."""
    assert batch.signals is not None, "periodic records"
    periods = batch.raw_freedom / 2 + 1
    known = batch.variances[:, ~batch.real]
    return float(np.mean(known[np.isfinite(known)]) * batch.signals.shape[1] * periods)
