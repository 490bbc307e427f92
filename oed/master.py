"""The small linear matrix inequality over the spectra found so far."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import clarabel
import numpy as np
from scipy.sparse import csc_array

from identification.arrays import BoolArray, FloatArray, IntArray
from oed.low_rank_master import solve_low_rank
from oed.spectra.family import Block

MOST_GENERAL = 10


@dataclass(frozen=True, eq=False)
class MasterSolution:
    """Weights W of the blocks, multipliers Z (J, k, k) of the targets, μ (M,) of the caps and ν (L, M) of the limits,
    and the shortfall t.
    """

    weights: list[FloatArray]
    prices: FloatArray
    cap_prices: FloatArray
    tolls: FloatArray
    shortfall: float
    solved: bool


def solve_master(
    blocks: Sequence[Block],
    targets: FloatArray,
    caps: FloatArray,
    *,
    shortfall_only: bool = False,
    accuracy: float = 1e-8,
) -> MasterSolution:
    """The least energy over blocks b for targets R_j (J, k, k), under caps α (M,) (infinite: none).

        min Σ_b tr W_b   s.t.   Σ_b Σ_rs (W_b)_rs I_b,rs ⪰ R_j for all j,   Σ_{b at m} tr W_b ≤ α_m,   W_b ⪰ 0,
                                Σ_{b at m} tr U_b,l W_b ≤ 1 for every limit l

    With `shortfall_only` the energy is free and the least t ≥ 0 is sought for which the targets (1 − t) R_j are met.
    Single spectra that tell little more than one direction each, of many parameters and without caps or limits, are
    solved by `low_rank_master`, everything else by the general conic solver.
    """
    free = not np.isfinite(caps).any() and all(block.use is None for block in blocks)
    if targets.shape[-1] > MOST_GENERAL and free and all(block.parts for block in blocks):
        found = solve_low_rank(blocks, targets, accuracy)
        if found.solved:
            nothing = np.zeros(len(caps))
            return MasterSolution(
                list(found.weights[:, None, None]), found.prices, nothing, nothing[None, :0], 0.0, True
            )
    layout = _Layout([len(block.shapes) for block in blocks])
    capped = np.intersect1d(np.flatnonzero(np.isfinite(caps)), [block.point for block in blocks])
    k, j = targets.shape[-1], len(targets)
    information = np.hstack([_information_columns(block) for block in blocks])
    used, use_rows = _use_rows(blocks, layout, len(caps))
    rows = [-layout.cone_rows(), _cap_rows(blocks, layout, capped), use_rows, -np.tile(information, (j, 1))]
    goal = np.concatenate([svec(target) for target in targets])
    right = np.concatenate([np.zeros(layout.size), caps[capped], np.ones(len(use_rows)), -goal])
    cost = layout.energy.copy()
    matrix = np.vstack(rows)
    cones = [
        *layout.cones(),
        clarabel.NonnegativeConeT(len(capped) + len(use_rows)),
        *[clarabel.PSDTriangleConeT(k)] * j,
    ]
    if shortfall_only:
        matrix = np.vstack([np.column_stack([matrix, np.zeros(len(matrix))]), np.eye(1, layout.size + 1, layout.size)])
        matrix[-1 - len(goal) : -1, -1] = -goal
        matrix[-1, -1] = -1.0
        right, cost = np.append(right, 0.0), np.append(np.zeros(layout.size), 1.0)
        cones.append(clarabel.NonnegativeConeT(1))
    solution = _solve(cost, matrix, right, cones, accuracy)
    x, z = np.array(solution.x), np.array(solution.z)[layout.size :]
    first = len(capped) + len(use_rows)
    prices = np.array([smat(part, k) for part in z[first : first + len(goal)].reshape(j, -1)])
    tolls = np.zeros(used.shape)
    tolls[used] = z[len(capped) : first]
    cap_prices = np.zeros(len(caps))
    cap_prices[capped] = z[: len(capped)]
    shortfall = float(x[-1]) if shortfall_only else 0.0
    solved = str(solution.status) in ("Solved", "AlmostSolved", "InsufficientProgress")
    return MasterSolution(layout.weights(x), prices, cap_prices, tolls, shortfall, solved)


def svec(matrix: FloatArray) -> FloatArray:
    """The upper triangle of symmetric matrices (…, k, k), column by column, off-diagonal entries times √2."""
    rows, columns, scale = _triangle(matrix.shape[-1])
    return np.asarray(matrix[..., rows, columns] * scale)


def smat(vector: FloatArray, k: int) -> FloatArray:
    """The symmetric matrix (k, k) whose `svec` is given."""
    rows, columns, scale = _triangle(k)
    matrix = np.zeros((k, k))
    matrix[rows, columns] = matrix[columns, rows] = vector / scale
    return matrix


@cache
def _triangle(k: int) -> tuple[IntArray, IntArray, FloatArray]:
    columns, rows = np.tril_indices(k)
    return rows, columns, np.where(rows == columns, 1.0, np.sqrt(2))


class _Layout:
    """Where the weights of the blocks stand in the vector of unknowns: scalars first, then triangles."""

    def __init__(self, sizes: list[int]) -> None:
        self.sizes = sizes
        lengths = [size * (size + 1) // 2 for size in sizes]
        ends = np.cumsum(lengths)
        self.slices = [slice(end - length, end) for end, length in zip(ends, lengths, strict=True)]
        self.size = int(ends[-1])
        self.energy = np.concatenate([svec(np.eye(size)) for size in sizes])
        scalar = [part.start for part, size in zip(self.slices, sizes, strict=True) if size == 1]
        larger = [part for part, size in zip(self.slices, sizes, strict=True) if size > 1]
        self.order = np.concatenate([scalar, *(np.arange(part.start, part.stop) for part in larger)]).astype(np.int64)
        self.scalars = len(scalar)

    def cone_rows(self) -> FloatArray:
        """The unknowns in the order of their cones."""
        return np.eye(self.size)[self.order]

    def cones(self) -> list[object]:
        """The cones that the weights lie in."""
        larger = [clarabel.PSDTriangleConeT(size) for size in self.sizes if size > 1]
        return [clarabel.NonnegativeConeT(self.scalars), *larger]

    def weights(self, x: FloatArray) -> list[FloatArray]:
        """The weight of each block; an interior solution, positive up to the accuracy of the solver."""
        return [smat(x[part], size) for part, size in zip(self.slices, self.sizes, strict=True)]


def _information_columns(block: Block) -> FloatArray:
    rows, columns, scale = _triangle(len(block.shapes))
    return np.asarray((svec(block.information[rows, columns]) * scale[:, None]).T)


def _cap_rows(blocks: Sequence[Block], layout: _Layout, capped: IntArray) -> FloatArray:
    rows = np.zeros((len(capped), layout.size))
    for block, part in zip(blocks, layout.slices, strict=True):
        rows[capped == block.point, part] = layout.energy[part]
    return rows


def _use_rows(blocks: Sequence[Block], layout: _Layout, places: int) -> tuple[BoolArray, FloatArray]:
    """Which limits the blocks take something of at which points (L, M), and what, one row each."""
    limits = 0 if blocks[0].use is None else len(blocks[0].use)
    rows = np.zeros((limits, places, layout.size))
    for block, part in zip(blocks, layout.slices, strict=True):
        if block.use is not None:
            rows[:, block.point, part] = svec(block.use)
    used = np.any(rows != 0, axis=-1)
    return used, rows[used]


def _solve(
    cost: FloatArray, matrix: FloatArray, right: FloatArray, cones: list[object], accuracy: float
) -> clarabel.DefaultSolution:
    return clarabel.DefaultSolver(
        _no_quadratic(len(cost)), cost, _columns(matrix), right, cones, _settings(accuracy)
    ).solve()


def _columns(matrix: FloatArray) -> csc_array:
    columns, rows = np.nonzero(matrix.T)
    starts = np.searchsorted(columns, np.arange(matrix.shape[1] + 1))
    return csc_array((matrix[rows, columns], rows, starts), shape=matrix.shape)


@cache
def _no_quadratic(size: int) -> csc_array:
    return csc_array((size, size))


def _settings(accuracy: float) -> clarabel.DefaultSettings:
    """One thread, and without the preparations that only pay for large sparse problems."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = accuracy
    return settings
