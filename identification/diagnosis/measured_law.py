"""The measured output put into the laws of effects: forces are then known, and the equation of motion is linear."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.extension.fit import Fit, gauss_newton_step, moved, penalised
from identification.extension.rows import Rows, effect_tangents
from identification.models.model import Model
from identification.outcome import Outcome
from identification.places.core import Reshaped
from identification.places.place import Flow

ITERATIONS, SETTLED = 12, 1e-4
HALVINGS = 5
ABOVE_NOISE = 2.0


@dataclass(frozen=True, eq=False)
class Nuisance:
    """What else may stand in the equation of motion of each record: columns (c, M, K), multiplied by free numbers.

    Beside a transient such as the polynomial I(jω) of the initial state; they are projected out record by record.
    """

    columns: ComplexArray

    def left(self, batch: Batch, rows: FloatArray, divisor: ComplexArray) -> FloatArray:
        """Rows (…, R) of a batch without what the columns over A (M, K) can take up."""
        basis = batch.whiten(self.columns / divisor).reshape(len(self.columns), len(batch.points), -1)
        split = rows.reshape(*rows.shape[:-1], len(batch.points), -1)
        q, _ = np.linalg.qr(np.moveaxis(basis, 0, -1))
        return np.asarray(split - np.einsum("mrc,msc,...ms->...mr", q, q, split, optimize=True)).reshape(rows.shape)


def denoised(batch: Batch) -> ComplexArray:
    """The measured output (M, K) with its lines shrunk by what noise makes of them: Y max(0, 1 − 2σ²/|Y|²)."""
    power = np.maximum(abs(batch.outputs) ** 2, np.finfo(float).tiny)
    known = np.isfinite(batch.variances)
    noise = np.where(known & batch.scaled, batch.variances, 0.0)
    return np.asarray(batch.outputs * np.where(known, np.maximum(0.0, 1 - ABOVE_NOISE * noise / power), 0.0))


def measured_fit(model: Model, rows: Rows, nuisance: Sequence[Nuisance] = (), iterations: int = ITERATIONS) -> Fit:
    """θ and effects from the equation of motion with the measured output in it.

        min Σ |A(jω; ζ) X̄ − B(jω; ζ) (g(U) − Σ e_j F{f_j(x̄, x̄̇)}) − I|²/(|Â|² σ²)

    X̄ is what reaches the sensor, taken back through sensor and linear effects; the forces f_j are evaluated at it on a
    finer time grid. Nothing is simulated, so that there is a result where no steady state is found, where the plant is
    unstable or in a loop. Linear in ζ and e but for their product; Â is that of the iteration before
    [Sanathanan1963]. Noise within f attenuates what it is an argument of: a scan and a start, not an estimate.
    Structures that are not rational, and inputs seen through a hold, keep A = 1 and B = G. `nuisance`, one for each
    batch: columns of I.
    """
    current = _at(model, rows, nuisance)
    for i in range(iterations):
        step, promised = gauss_newton_step(*penalised(current))
        if promised < SETTLED * (1 + float(current.residual @ current.residual)):
            return replace(current, outcome=Outcome("converged", "", i))
        current = _descended(current, step, nuisance)
    return current


def _descended(current: Fit, step: FloatArray, nuisance: Sequence[Nuisance]) -> Fit:
    """After the longest of the halved steps that leaves ‖r‖ less than the equation with the old Â had."""
    before = float(current.residual @ current.residual)
    for halving in range(HALVINGS):
        found = _at(moved(current, step / 2**halving), current.rows, nuisance)
        if float(found.residual @ found.residual) < 4 * before or halving == HALVINGS - 1:
            return found
    return current


def _at(model: Model, rows: Rows, nuisance: Sequence[Nuisance]) -> Fit:
    flows = tuple(model.follow(batch, denoised(batch)) for batch in rows.batches)
    residual = rows.residual(flows)
    tangents = np.concatenate(
        [_plant_tangents(model, rows, flows), *(effect_tangents(one, rows, flows) for one in model.effects)]
    )
    if nuisance:
        residual, tangents = (_without(rows, part, flows, nuisance) for part in (residual, tangents))
    return Fit(model, residual, tangents, flows, rows, Outcome("not_converged", "the law did not settle", ITERATIONS))


def _without(rows: Rows, values: FloatArray, flows: Sequence[Flow], nuisance: Sequence[Nuisance]) -> FloatArray:
    parts = zip(rows.batches, rows.parts(values), flows, nuisance, strict=True)
    return np.concatenate(
        [n.left(b, part, _denominator(flow)[:, 0] / flow.factor) for b, part, flow, n in parts], axis=-1
    )


def _denominator(flow: Flow) -> ComplexArray:
    """A (M, 1 + m, K) with its derivatives; without them where an input is seen through a hold or effects reshape G."""
    found = flow.setting.structure.characteristic(flow.setting.zeta, flow.batch.omega)
    otherwise = flow.held is not None or any(isinstance(effect, Reshaped) for effect, _ in flow.acting)
    return found[:, :1] if otherwise else found


def _plant_tangents(model: Model, rows: Rows, flows: Sequence[Flow]) -> FloatArray:
    """The change by θ_G of (B D − A X̄)/Â, D the drive, whitened, (k_G, R)."""
    spectra = []
    for flow in flows:
        by_zeta = np.swapaxes(_by_coefficients(flow), 1, 2)
        spectra.append(np.moveaxis(model.pulled(by_zeta, flow.batch.points), -1, 0))
    return rows.whiten(spectra)


def _by_coefficients(flow: Flow) -> ComplexArray:
    """(M, n_plant, K): through B and delay the drive acts, through A the measured output instead of the simulated."""
    divisor = _denominator(flow)
    change = flow.by_coefficients.copy()
    count = divisor.shape[1] - 1
    measured = -divisor[:, 1:] / divisor[:, :1] * (flow.core * flow.factor)[:, None, :]
    passed = 1.0 if flow.setting.passed is None else flow.setting.passed[:, :count, None]
    change[:, :count] = measured * passed
    return change
