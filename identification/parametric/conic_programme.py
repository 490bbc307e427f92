"""The smallest misfit under matrix inequalities, in the standard form of the conic solver."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from scipy.sparse import csc_matrix

from identification.arrays import FloatArray

Misfit = Literal["frobenius", "spectral"]
Affine = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Blocks:
    """min ‖residuals(Ã, X)‖ s.t. negative(Ã, X) ⪯ 0, and X ⪰ I when X is unknown (`symmetric`) or X = I otherwise.

    `size` (J, n): Ã is (J, n, n) and X (n, n). Both functions are linear and take a batch (N, J, n, n), (N, n, n):
    `residuals` gives (blocks, N, rows, n) and `negative` (blocks, N, d, d), symmetric.
    """

    size: tuple[int, int]
    misfit: Misfit
    residuals: Affine
    negative: Affine
    symmetric: bool

    def units(self) -> tuple[FloatArray, FloatArray]:
        """Ã and X for every unknown being one and the others zero, (N, J, n, n) and (N, n, n)."""
        j, n = self.size
        free = np.eye(j * n * n).reshape(-1, j, n, n)
        if not self.symmetric:
            return free, np.zeros((len(free), n, n))
        row, column = np.triu_indices(n)
        extra = np.zeros((len(row), n, n))
        extra[range(len(row)), row, column] = extra[range(len(row)), column, row] = 1.0
        return (
            np.concatenate([free, np.zeros((len(row), j, n, n))]),
            np.concatenate([np.zeros((len(free), n, n)), extra]),
        )

    def constants(self) -> tuple[FloatArray, FloatArray]:
        """Ã and X for all unknowns zero, as a batch of one."""
        j, n = self.size
        return np.zeros((1, j, n, n)), np.zeros((1, n, n)) if self.symmetric else np.eye(n)[None]


@dataclass(frozen=True, eq=False)
class ConicSolution:
    """Ã (J, n, n), X (n, n), the smallest misfit, and whether the solver reached it."""

    free: FloatArray
    symmetric: FloatArray
    misfit: float
    iterations: int
    solved: bool


def minimised_misfit(blocks: Blocks) -> ConicSolution:
    """The solution of the problem by an interior-point method."""
    unit_a, unit_x = blocks.units()
    zero_a, zero_x = blocks.constants()
    count = len(unit_a)
    parts = _misfit_cones(blocks, (unit_a, unit_x), (zero_a, zero_x))
    negative, constant = blocks.negative(unit_a, unit_x), blocks.negative(zero_a, zero_x)
    parts += [_semidefinite(-linear, -fixed[0], 0.0) for linear, fixed in zip(negative, constant, strict=True)]
    if blocks.symmetric:
        parts.append(_semidefinite(unit_x, -np.eye(blocks.size[1]), 0.0))
    matrix = np.vstack([part.rows for part in parts])
    right = np.concatenate([part.right for part in parts])
    cost = np.zeros(count + 1)
    cost[-1] = 1.0
    solution = (
        _solver()
        .DefaultSolver(
            csc_matrix((count + 1, count + 1)), cost, csc_matrix(matrix), right, [p.cone for p in parts], _settings()
        )
        .solve()
    )
    x = np.array(solution.x)
    free = np.einsum("n,njab->jab", x[:-1], unit_a)
    symmetric = np.einsum("n,nab->ab", x[:-1], unit_x) + zero_x[0]
    solved = str(solution.status) in ("Solved", "AlmostSolved") and bool(np.all(np.isfinite(x)))
    return ConicSolution(free, symmetric, float(x[-1]), int(solution.iterations), solved)


@dataclass(frozen=True, eq=False)
class _Part:
    """right − rows (x, t) in a cone."""

    rows: FloatArray
    right: FloatArray
    cone: Any


def _misfit_cones(
    blocks: Blocks, units: tuple[FloatArray, FloatArray], zeros: tuple[FloatArray, FloatArray]
) -> list[_Part]:
    """‖residuals‖ ≤ t, all together in one second-order cone or each in a semidefinite one."""
    linear, fixed = blocks.residuals(*units), blocks.residuals(*zeros)
    if blocks.misfit == "spectral":
        return [_semidefinite(_dilated(a), _dilated(b)[0], 1.0) for a, b in zip(linear, fixed, strict=True)]
    count = linear.shape[1]
    body = linear.transpose(0, 2, 3, 1).reshape(-1, count)
    rows = np.zeros((len(body) + 1, count + 1))
    rows[0, -1], rows[1:, :-1] = -1.0, -body
    return [_Part(rows, np.concatenate([[0.0], fixed.ravel()]), _solver().SecondOrderConeT(len(rows)))]


def _dilated(matrices: FloatArray) -> FloatArray:
    """[0 Fᵀ; F 0] of F (N, rows, n)."""
    count, rows, n = matrices.shape
    result = np.zeros((count, rows + n, rows + n))
    result[:, n:, :n], result[:, :n, n:] = matrices, np.swapaxes(matrices, 1, 2)
    return result


def _semidefinite(linear: FloatArray, constant: FloatArray, identity: float) -> _Part:
    """Σ x_i linear_i + constant + t identity I ⪰ 0, as scaled upper triangles column by column."""
    size = len(constant)
    column, row = np.tril_indices(size)
    scale = np.where(row == column, 1.0, np.sqrt(2.0))
    multiple = identity * (row == column)
    rows = np.column_stack([-(linear[:, row, column] * scale).T, -multiple])
    return _Part(rows, constant[row, column] * scale, _solver().PSDTriangleConeT(size))


def _settings() -> Any:
    settings = _solver().DefaultSettings()
    settings.verbose = False
    settings.max_iter = 200
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    return settings


def _solver() -> Any:
    """The conic solver, loaded with the first problem only."""
    import clarabel

    return clarabel
