"""Every record with coefficients of its own, and whether they scatter about ζ(p) = T(p) θ by more than their errors."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.extension.fit import Fit, fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.scheduling import ParameterDependence, ProductBasis

UNHEARD = 1e24
SPREADS = np.geomspace(1e-6, 10.0, 141)
ITERATIONS = 40


@dataclass(frozen=True, eq=False)
class RecordByRecord:
    """ζ̂ (N, n) of N records, each fitted alone, with its information (N, n, n) and T (N, n, k_G), n = n_plant.

    `energy`: the sum of the squares of what all these fits leave.
    """

    coefficients: FloatArray
    information: FloatArray
    transfer: FloatArray
    energy: float

    def scattered(self, coefficient: int) -> tuple[float, float, float]:
        """τ̂ of ζ_i = (T θ)_i (1 + τ n_r), Σ dᵀ V⁻¹ d of d = ζ̂ − T θ̂ with V_r = I_r⁻¹ + τ² ζ_i² e_i e_iᵀ, and Σ ln det.

        V⁻¹ = I − I e_i e_iᵀ I / (1/(τ ζ_i)² + I_ii), so that what a record does not tell of the others may be singular;
        τ̂ is the likeliest on a grid, by restricted likelihood [Searle1992, Section 6.6].
        """
        tried = [(float(size), *self._at(coefficient, size)) for size in SPREADS]
        return min(tried, key=lambda one: sum(one[1:]))[:3]

    def _at(self, i: int, size: float) -> tuple[float, float, float]:
        spread = (size * self.coefficients[:, i]) ** 2
        column, own = self.information[:, :, i], self.information[:, i, i]
        taken = spread / (1 + spread * own)
        weights = self.information - taken[:, None, None] * column[:, :, None] * column[:, None, :]
        normal = np.einsum("rnk,rnm,rml->kl", self.transfer, weights, self.transfer)
        right = np.einsum("rnk,rnm,rm->k", self.transfer, weights, self.coefficients)
        off = self.coefficients - self.transfer @ np.linalg.lstsq(normal, right, rcond=None)[0]
        energy = float(np.einsum("rn,rnm,rm->", off, weights, off))
        return energy, float(np.sum(np.log1p(spread * own))), float(np.linalg.slogdet(normal)[1])


def record_by_record(base: Fit) -> RecordByRecord | None:
    """The records of a fit, each fitted alone; None where effects act or where one does not tell its coefficients."""
    model = base.model
    if model.effects or model.chart is not None:
        return None
    found = [_alone(base, *place) for place in _places(base)]
    fits = [one for one in found if one is not None]
    if len(fits) < len(found):
        return None
    n, points = model.structure.n_plant, np.concatenate([batch.points for batch in base.rows.batches])
    return RecordByRecord(
        np.array([one.model.theta[:n] for one in fits]),
        np.array([one.tangents @ one.tangents.T for one in fits]),
        model.dependence.matrix(points)[:, :n, : model.plant_size],
        sum(float(np.sum(base.rows.judged(one.residual) ** 2)) for one in fits),
    )


def _places(base: Fit) -> Iterator[tuple[int, int]]:
    for number, batch in enumerate(base.rows.batches):
        yield from ((number, m) for m in range(len(batch.points)))


def _alone(base: Fit, number: int, record: int) -> Fit | None:
    """The fit of one record, the others unheard."""
    kept = []
    for i, batch in enumerate(base.rows.batches):
        heard = (np.arange(len(batch.points)) == record) & (i == number)
        kept.append(replace(batch, variances=np.where(heard, 1.0, UNHEARD)[:, None] * batch.variances))
    begun = _constant(base.model, base.rows.batches[number].points[record])
    found = fit(begun, Rows(tuple(kept), base.rows.scales), iterations=ITERATIONS)
    return found if found.outcome.ok else None


def _constant(model: Model, point: FloatArray) -> Model:
    """The model of one operating point, whatever p is."""
    dependence, zeta = model.dependence, model.coefficients(point[None])[0]
    flat = ProductBasis((Polynomial(0),) * len(dependence.variables))
    constant = ParameterDependence(dependence.variables, (flat,) * len(dependence.bases), dependence.entries)
    return Model(model.structure, constant, zeta, np.eye(len(zeta)), model.noise_variance)
