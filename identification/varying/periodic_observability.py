"""Observability matrices of a periodic system, and the state basis that they have in common."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError

SMALLEST_EXCITATION = 1e-9


@dataclass(frozen=True, eq=False)
class PeriodicObservability:
    """`bases` (T, d n_y, n_x): orthonormal columns spanning O_t at every phase t, each in a state basis of its own.

    `singular_values` (T, d n_y): of what the instruments explain, for the choice of the order.
    """

    bases: FloatArray
    singular_values: FloatArray


def periodic_observability(
    input: FloatArray, output: FloatArray, period: int, window: int, order: int
) -> PeriodicObservability:
    """The column spaces of O_t, t = 0 … T − 1, with d past inputs and outputs as instruments [Goos2014, (7)–(9)].

        Y_t = O_t X_t + 𝒯_t U_t + E_t,   [U_t; Z_{t−d}; Y_t] = R Qᵀ,   range O_t = range R_32

    Column k of Y_t, U_t (d rows of blocks) starts at t + kT, the instruments Z d samples before. R_32 is what the
    future output shares with the past once the future input is projected out; future white noise is independent of it.
    Raises NotIdentifiableError when the record is too short or the input excites too little.
    """
    bases, values = [], []
    for phase in range(period):
        start = phase if phase >= window else phase + period * (-(-(window - phase) // period))
        columns = np.arange(start, len(input) - window + 1, period)
        future = columns[:, None] + np.arange(window)
        sources = ((input, future), (input, future - window), (output, future - window), (output, future))
        blocks = [x[i].reshape(len(columns), -1) for x, i in sources]
        u_rows, z_rows = blocks[0].shape[1], blocks[1].shape[1] + blocks[2].shape[1]
        stacked = np.concatenate(blocks, axis=1)
        if len(stacked) < stacked.shape[1]:
            raise NotIdentifiableError(
                f"the record gives {len(stacked)} columns a phase of the scheduling, {stacked.shape[1]} are needed for"
                f" windows of {window}; record longer or choose a smaller window",
                "window",
            )
        triangle = np.asarray(np.linalg.qr(stacked, mode="r")).T
        excitation = np.linalg.svd(triangle[:u_rows, :u_rows], compute_uv=False)
        if excitation[-1] <= SMALLEST_EXCITATION * excitation[0]:
            raise NotIdentifiableError(
                f"the input has too low a rank for windows of {window} at phase {phase} of the scheduling; excite more"
                " frequencies, or with an input period that is not a short multiple of the scheduling period",
                "input",
            )
        left, singular, _ = np.linalg.svd(triangle[u_rows + z_rows :, u_rows : u_rows + z_rows])
        bases.append(left[:, :order])
        values.append(singular)
    return PeriodicObservability(np.stack(bases), np.stack(values))


@dataclass(frozen=True, eq=False)
class CommonBasis:
    """O_t in one state basis, (T, d n_y, n_x), and the `correlations` (min(T n_x, n_x + 1),), the largest first.

    Only n_x of them are near one when the scheduling determines the basis.
    """

    bases: FloatArray
    correlations: FloatArray


def common_basis(
    bases: FloatArray, weights: FloatArray, n_y: int, regularisation: float, varying_output: bool = True
) -> CommonBasis:
    """O_t T_t in one state basis, by canonical correlation [Goos2014, (11)–(14)].

        max tr Tᵀ Ôᵀ K (K + ν s I)⁻¹ Ô T,   Tᵀ T = I,   K = M Mᵀ,   Ô = blockdiag(Ô_t)

    Row j of O_t is affine in the products p(t+j) ⊗ … ⊗ p(t) (`weights` (T, 1 + n_p), 1 first), so the kernel K
    between phases s and t is Π_{i ≤ j} p(s+i)ᵀp(t+i) and couples equal rows only; M itself, whose columns grow as
    (1 + n_p)^d, is never formed. s is the mean diagonal of K in its row, ν = `regularisation`. Where C does not vary
    (`varying_output` False) the factor p(t+j) is missing, and more is known.
    """
    period, rows, order = bases.shape
    per_row = bases.reshape(period, rows // n_y, n_y, order)
    matrix = np.zeros((period * order, period * order))
    for j, smooth in enumerate(_smoothers(weights, rows // n_y, regularisation, varying_output)):
        for y in range(n_y):
            row = per_row[:, j, y]
            matrix += (row[:, :, None, None] * smooth[:, None, :, None] * row[None, None, :, :]).reshape(matrix.shape)
    values, vectors = np.linalg.eigh(matrix)
    transform = vectors[:, -order:].reshape(period, order, order)
    return CommonBasis(bases @ transform * np.sqrt(period), values[::-1][: order + 1])


def _smoothers(weights: FloatArray, window: int, regularisation: float, varying_output: bool) -> Iterator[FloatArray]:
    """K (K + ν s I)⁻¹ (T, T) for the rows j = 0 … d − 1."""
    kernel = np.ones((len(weights), len(weights)))
    for j in range(window):
        if varying_output or j > 0:
            shifted = np.roll(weights, -j if varying_output else 1 - j, axis=0)
            kernel = kernel * (shifted @ shifted.T)
        values, vectors = np.linalg.eigh(kernel)
        values = np.maximum(values, 0.0)
        share = values / (values + regularisation * float(np.mean(np.diag(kernel))))
        yield (vectors * share) @ vectors.T
