"""Residuals and tangents of a model over several batches, whitened."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.comparison.noise import noise_freedom
from identification.models.model import Model
from identification.places.core import Reshaped
from identification.places.place import Effect, Flow
from identification.places.placed import PlacedEffect
from identification.places.recorder import Recorder

FURTHER_STEP = 1e-4


@dataclass(frozen=True, eq=False)
class Rows:
    """Several batches as one vector of R whitened numbers; `scales`: by what the errors of each batch are
    larger than stated, one unless given."""

    batches: tuple[Batch, ...]
    scales: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "scales", self.scales or (1.0,) * len(self.batches))

    def residual(self, flows: Sequence[Flow]) -> FloatArray:
        """(Y − Ŷ)/σ as rows, (R,)."""
        parts = zip(self.batches, flows, self.scales, strict=True)
        return np.concatenate([(batch.measured - batch.whiten(flow.output)) / scale for batch, flow, scale in parts])

    def whiten(self, spectra: Sequence[ComplexArray]) -> FloatArray:
        """Changes of the output (c, M, K), one array a batch, as (c, R)."""
        parts = zip(self.batches, spectra, self.scales, strict=True)
        return np.concatenate([batch.whiten(lines) / scale for batch, lines, scale in parts], axis=-1)

    def parts(self, rows: FloatArray) -> list[FloatArray]:
        """The rows (…, R) of each batch."""
        ends = np.cumsum([len(batch.compared) for batch in self.batches])[:-1]
        return np.split(rows, ends, axis=-1)

    def judged(self, residual: FloatArray) -> FloatArray:
        """The part of a residual (R,) that lack of fit is judged by.

        All of it where the noise is known without a model, else what lies in the general directions of a record.
        """
        return np.concatenate([_judged(b, part) for b, part in zip(self.batches, self.parts(residual), strict=True)])

    @cached_property
    def shares(self) -> FloatArray:
        """The degrees of freedom of each row of `judged`, (R,): one, or its share in the general directions."""
        return np.concatenate(
            [
                b.compared.astype(np.float64) if b.general is None else np.sum(b.general**2, axis=1).ravel()
                for b in self.batches
            ]
        )

    @property
    def count(self) -> int:
        """How many real numbers are compared."""
        return sum(batch.row_count for batch in self.batches)

    @property
    def noise_freedom(self) -> float:
        """Real degrees of freedom of the noise variances in the mean of the squares of all rows."""
        weights = [batch.compared / self.count for batch in self.batches]
        return noise_freedom(self.batches, weights)

    @property
    def scaled(self) -> bool:
        """Whether the size of the noise is known for all batches."""
        return all(batch.scaled for batch in self.batches)


def _judged(batch: Batch, rows: FloatArray) -> FloatArray:
    if batch.general is None:
        return rows
    parts = rows.reshape(len(batch.points), -1)
    onto = np.einsum("mr,mdr->md", parts, batch.general)
    return np.asarray(np.einsum("md,mdr->mr", onto, batch.general)).ravel()


def plant_tangents(model: Model, rows: Rows, flows: Sequence[Flow]) -> FloatArray:
    """∂Ŷ/∂θ_G whitened, (k_G, R)."""
    spectra = []
    for flow in flows:
        by_zeta = np.swapaxes(flow.by_coefficients, 1, 2)
        spectra.append(flow.recorded(np.moveaxis(model.pulled(by_zeta, flow.batch.points), -1, 0)))
    return rows.whiten(spectra)


def effect_tangents(one: PlacedEffect, rows: Rows, flows: Sequence[Flow], further: bool = True) -> FloatArray:
    """∂Ŷ by the amplitudes of an effect, and with `further` by its other parameters, whitened, (parameters, R)."""
    amplitudes = [_by_amplitudes(one.effect, one, flow) for flow in flows]
    others = [_by_further(one, name, flows) for name in one.effect.fitted_names()] if further else []
    spectra = [np.concatenate([part, *(column[b] for column in others)]) for b, part in enumerate(amplitudes)]
    return rows.whiten(spectra)


def _by_amplitudes(effect: Effect, one: PlacedEffect, flow: Flow) -> ComplexArray:
    basis = one.basis(flow.setting, flow.batch)
    tangent = effect.tangent(one.amplitude(flow.setting, flow.batch), flow)
    columns = tangent[:, None] * basis.T[None, :, :, None]
    found = np.asarray(columns.reshape(-1, *tangent.shape[1:]))
    return found if isinstance(effect, Recorder) else flow.recorded(found)


def _by_further(one: PlacedEffect, name: str, flows: Sequence[Flow]) -> list[ComplexArray]:
    """∂Ŷ/∂ ln η, (1, M, K) a batch: Σ c_ij ∂t_ij/∂ ln η where effects are linear in e, all but those that reshape."""
    names, values = one.effect.fitted_names(), one.effect.values()
    ends = [
        one.effect.with_values(np.where(np.array(names) == name, values * np.exp(side * FURTHER_STEP), values))
        for side in (1, -1)
    ]
    return [
        _between(replace(one, effect=ends[0]), replace(one, effect=ends[1]), flow) / (2 * FURTHER_STEP)
        for flow in flows
    ]


def _between(up: PlacedEffect, down: PlacedEffect, flow: Flow) -> ComplexArray:
    """The change of Y (1, M, K) from one value of a further parameter to another."""
    if isinstance(up.effect, Reshaped) and isinstance(down.effect, Reshaped):
        first = up.effect.seen(up.amplitude(flow.setting, flow.batch), flow)
        last = down.effect.seen(down.amplitude(flow.setting, flow.batch), flow)
        return flow.recorded(flow.through(first - last))[None]
    change = _by_amplitudes(up.effect, up, flow) - _by_amplitudes(down.effect, down, flow)
    return np.tensordot(up.coefficients.ravel(), change, axes=1)[None]
