"""Affine state-space models from sub-Markov parameters: the full and the basis-reduced Ho–Kalman realisation."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import NotIdentifiableError, RangeError
from identification.models.state_space import Matrices
from identification.varying.sub_markov import BasisSelection, SubMarkovSource, every_word


@dataclass(frozen=True, eq=False)
class Realisation:
    """Stacks a (k, n_x, n_x), b (k, n_x, n_u), c (k, n_y, n_x), d (k, n_y, n_u), and what they come from.

    `singular_values`: all those of the Hankel matrix, from the largest down.
    """

    matrices: Matrices
    singular_values: FloatArray

    @property
    def order(self) -> int:
        """n_x."""
        return int(self.matrices[0].shape[1])


def largest_entries(hankel: FloatArray, rows: int, columns: int) -> tuple[IntArray, IntArray]:
    """Positions of `rows` rows and `columns` columns that hold the largest absolute entries of a matrix [Cox2018, 5.1].

    The entries are gone through from the largest down; each adds its row and its column as long as there is room.
    Raises RangeError when the matrix has fewer rows or columns.
    """
    if not (1 <= rows <= hankel.shape[0] and 1 <= columns <= hankel.shape[1]):
        raise RangeError(
            f"{rows} rows and {columns} columns cannot be selected from a matrix of {hankel.shape[0]} by"
            f" {hankel.shape[1]}; select fewer or use longer words",
            "rows",
        )
    order = np.argsort(-abs(hankel), axis=None, kind="stable")
    row, column = np.unravel_index(order, hankel.shape)
    return _first_distinct(row, rows), _first_distinct(column, columns)


def _first_distinct(values: IntArray, count: int) -> IntArray:
    _, first = np.unique(values, return_index=True)
    return np.asarray(values[np.sort(first)[:count]])


def order_by_singular_values(values: FloatArray) -> int:
    """The last n in the first half of σ₁ ≥ σ₂ ≥ … whose drop σ_n / σ_{n+1} is at least 0.7 of the largest there.

    Values below 1e-12 σ₁ count as rounding. Raises NotIdentifiableError when all are zero.
    """
    if not len(values) or values[0] <= 0:
        raise NotIdentifiableError("the sub-Markov parameters are all zero; check the data", "output")
    floored = np.maximum(values, 1e-12 * values[0])
    drops = (floored[:-1] / floored[1:])[: (len(values) + 1) // 2]
    return int(np.flatnonzero(drops >= 0.7 * drops.max())[-1]) + 1 if len(drops) else 1


def reduced_realisation(
    source: SubMarkovSource, rows: BasisSelection, columns: BasisSelection, order: int | None = None
) -> Realisation:
    """The basis-reduced Ho–Kalman realisation [Cox2018, Theorem 4, (21), (22)].

        ℋ_{ν,ς} = U Σ Vᵀ,   Â_k = Σ^{-½}Uᵀ ℋ_{ν,ς,k} VΣ^{-½},   B̂_k = Σ^{-½}Uᵀ ℋ_{ν,k},   Ĉ_k = ℋ_{k,ς} VΣ^{-½}

    `order` n_x; None takes it from the singular values. Exact for exact parameters when ℋ_{ν,ς} has rank n_x.
    Raises RangeError for an order above the size of the bases, NotIdentifiableError for a lower rank.
    """
    blocks = source.blocks(rows, columns)
    u, values, v = np.linalg.svd(blocks.hankel)
    n = _checked_order(values, order)
    root = np.sqrt(values[:n])
    left, right = u[:, :n].T / root[:, None], v[:n].T / root
    matrices = (left @ blocks.shifted @ right, left @ blocks.from_input, blocks.to_output @ right, blocks.direct)
    return Realisation(matrices, values)


def full_realisation(
    source: SubMarkovSource, depths: tuple[int, int] = (2, 2), order: int | None = None
) -> Realisation:
    """The Ho–Kalman realisation of the full extended Hankel matrix ℋ_ij = 𝒪_i ℛ_j [Cox2018, (13)].

        ℋ_ij = U Σ Vᵀ,   ℛ_j = Σ^½ Vᵀ,   𝒪_i = U Σ^½;   A_k ℛ_{j−1} = the columns of ℛ_j whose words begin with k

    `depths` (i, j): letters of the longest words, j ≥ 2; B and C are the blocks of one letter. Exact for exact
    parameters when ℋ_ij and ℛ_{j−1} have rank n_x. Raises RangeError and NotIdentifiableError like the reduced one.
    """
    depth_rows, depth_columns = depths
    if depth_rows < 1 or depth_columns < 2:
        raise RangeError(f"depths are {depths}; words of rows need a letter and words of columns two", "depths")
    direct = source.direct()
    k, n_y, n_u = direct.shape
    rows, columns = every_word(depth_rows, k, n_y), every_word(depth_columns, k, n_u)
    u, values, v = np.linalg.svd(source.hankel(rows, columns), full_matrices=False)
    n = _checked_order(values, order)
    root = np.sqrt(values[:n])
    observability, reachability = u[:, :n] * root, root[:, None] * v[:n]
    shorter = len(every_word(depth_columns - 1, k, n_u))
    if np.linalg.matrix_rank(reachability[:, :shorter], 1e-10 * float(np.linalg.norm(reachability))) < n:
        raise _rank_error(n)
    inverse = np.linalg.pinv(reachability[:, :shorter])
    A = np.stack([reachability[:, places] @ inverse for places in _prolonged(depth_columns, k, n_u)])
    B = reachability[:, : k * n_u].reshape(n, k, n_u).transpose(1, 0, 2)
    C = observability[: k * n_y].reshape(k, n_y, n)
    return Realisation((A, B, C, direct), values)


def _prolonged(depth: int, k: int, n_u: int) -> list[IntArray]:
    """For each letter: where in ℛ_depth the columns of ℛ_{depth−1} stand once that letter is put before them."""
    starts = np.cumsum([0, *(k**length * n_u for length in range(1, depth))])
    return [
        np.concatenate(
            [starts[m] + letter * k**m * n_u + np.arange(k**m * n_u, dtype=np.int64) for m in range(1, depth)]
        )
        for letter in range(k)
    ]


def _checked_order(values: FloatArray, order: int | None) -> int:
    n = order_by_singular_values(values) if order is None else order
    if not 1 <= n <= len(values):
        raise RangeError(
            f"order {n} needs a Hankel matrix of at least that size, it has {len(values)}; select more rows and"
            " columns",
            "order",
        )
    if values[n - 1] <= 1e-12 * values[0]:
        raise _rank_error(n)
    return n


def _rank_error(order: int) -> NotIdentifiableError:
    return NotIdentifiableError(
        f"the Hankel matrix has a rank below {order}; choose a lower order, longer words or more rows and columns",
        "order",
    )
