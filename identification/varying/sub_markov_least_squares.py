"""Sub-Markov parameters from records of any input and scheduling, by least squares."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import qr, solve_triangular

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError, RangeError, ShapeError
from identification.varying.sub_markov import BasisSelection, HankelBlocks, Word

MOST_REGRESSORS = 20_000


@dataclass(frozen=True, eq=False)
class WordRegression:
    """The regression of any output on all products of up to n samples of the scheduling and one of the input.

        y(t) = Σ_{n=1}^{L} Σ_{s₁…s_n} g_{s₁…s_n} ψ_{s₁}(t) ⋯ ψ_{s_n}(t−n+1) u(t−n+1) + remainder     [Cox2018, (4), (5)]

    `psi` (N, k), ψ₀ = 1 first; `input` (N, n_u), from rest; `longest` L. Nothing need be white; longer words stay in
    the remainder. `ridge` ρ ≥ 0 adds ρ N σ_j² to the diagonal of the normal equations, σ_j the root mean square of
    regressor j. The factorisation is kept, so that further outputs cost little. Raises ShapeError, RangeError (L < 2,
    ρ < 0), and NotIdentifiableError when there are more regressors than samples or they are linearly dependent.
    """

    psi: FloatArray
    input: FloatArray
    longest: int = 3
    ridge: float = 0.0

    def __post_init__(self) -> None:
        if len(self.psi) != len(self.input):
            raise ShapeError(
                f"{len(self.psi)} samples of scheduling and {len(self.input)} of the input were given", "input"
            )
        if self.longest < 2:
            raise RangeError(f"the longest word has {self.longest} letters; C_i B_j needs two", "longest")
        if not (np.isfinite(self.ridge) and self.ridge >= 0):
            raise RangeError(f"the ridge is {self.ridge}; it must not be negative", "ridge")
        if (self.ridge == 0 and self.size > len(self.psi)) or self.size > MOST_REGRESSORS:
            raise NotIdentifiableError(
                f"words of up to {self.longest} letters make {self.size} regressors, the record has {len(self.psi)}"
                " samples; record longer, shorten the words or use a ridge",
                "longest",
            )

    @property
    def size(self) -> int:
        """Number of regressors."""
        k = self.psi.shape[1]
        return int(self.input.shape[1] * sum(k**length for length in range(1, self.longest + 1)))

    @cached_property
    def _factor(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        regressors = self._regressors()
        scale = np.linalg.norm(regressors, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        scaled = regressors / scale
        if self.ridge > 0:
            scaled = np.concatenate([scaled, np.sqrt(self.ridge) * np.eye(self.size)])
        q, r = qr(scaled, mode="economic", check_finite=False)
        if abs(np.diag(r)).min() <= 1e-9:
            raise NotIdentifiableError(
                "the products of scheduling and input are linearly dependent in this record; excite more, shorten the"
                " words or use a ridge",
                "scheduling",
            )
        return np.asarray(q[: len(self.psi)]), np.asarray(r), scale

    def _regressors(self) -> FloatArray:
        """(N, size): by length, then word, then channel of the input."""
        n = len(self.psi)
        parts, longer = [], self.input
        for _ in range(self.longest):
            longer = (self.psi[:, :, None] * longer[:, None, :]).reshape(n, -1)
            parts.append(longer)
            longer = np.concatenate([np.zeros((1, longer.shape[1])), longer[:-1]])
        return np.concatenate(parts, axis=1)

    def fit(self, output: FloatArray) -> "TabledSubMarkov":
        """The parameters of an output (N, n_y). Raises ShapeError when its length differs."""
        if len(output) != len(self.psi):
            raise ShapeError(f"the output has {len(output)} samples, the input {len(self.psi)}", "output")
        q, r, scale = self._factor
        found = solve_triangular(r, q.T @ output) / scale[:, None]
        tables, start = [], 0
        k, n_u = self.psi.shape[1], self.input.shape[1]
        for length in range(1, self.longest + 1):
            stop = start + k**length * n_u
            tables.append(found[start:stop].reshape(k**length, n_u, -1).transpose(0, 2, 1))
            start = stop
        return TabledSubMarkov(tuple(tables), k)


@dataclass(frozen=True, eq=False)
class TabledSubMarkov:
    """Sub-Markov parameters of all words of up to L letters: `tables`[n−1] (kⁿ, n_y, n_u), words as numbers to base k.

    Raises RangeError when a selection asks for longer words.
    """

    tables: tuple[FloatArray, ...]
    basis_functions: int

    def _entry(self, word: Word, row: int, column: int) -> float:
        if len(word) > len(self.tables):
            raise RangeError(
                f"a word of {len(word)} letters is needed, {len(self.tables)} were fitted; fit longer words or select"
                " shorter rows and columns",
                "longest",
            )
        place = 0
        for letter in word:
            place = place * self.basis_functions + letter
        return float(self.tables[len(word) - 1][place, row, column])

    def _matrix(self, rows: BasisSelection, columns: BasisSelection, between: Word = ()) -> FloatArray:
        right = list(zip(columns.words, columns.channels, strict=True))
        return np.array(
            [
                [self._entry(left + between + word, i, j) for word, j in right]
                for left, i in zip(rows.words, rows.channels, strict=True)
            ]
        )

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς}, (n_o, n_r)."""
        _, n_y, n_u = self.tables[0].shape
        rows.require_within(self.basis_functions, n_y, "rows")
        columns.require_within(self.basis_functions, n_u, "columns")
        return self._matrix(rows, columns)

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""
        return self.tables[0]

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation."""
        k, (_, n_y, n_u) = self.basis_functions, self.tables[0].shape
        hankel = self.hankel(rows, columns)
        letters = range(k)
        outputs = [BasisSelection(((letter,),) * n_y, tuple(range(n_y))) for letter in letters]
        inputs = [BasisSelection(((letter,),) * n_u, tuple(range(n_u))) for letter in letters]
        return HankelBlocks(
            hankel,
            np.stack([self._matrix(rows, columns, (letter,)) for letter in letters]),
            np.stack([self._matrix(rows, each) for each in inputs]),
            np.stack([self._matrix(each, columns) for each in outputs]),
            self.tables[0],
        )
