"""Sub-Markov parameters C_i A_j ⋯ A_k B_l of affine state-space models, and selections of them."""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import Protocol

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import RangeError, ShapeError

Word = tuple[int, ...]


@dataclass(frozen=True)
class BasisSelection:
    """Rows or columns of the extended Hankel matrix: a word of basis functions and a channel each.

        row (γ a₁ … a_m, i):  C_γ^{[i]} A_{a₁} ⋯ A_{a_m}        column (a₁ … a_m β, j):  A_{a₁} ⋯ A_{a_m} B_β^{[j]}

    Letters stand in the order of the matrix product, the latest sample first (the strings of [Cox2018, (16), (18)] run
    the other way); letter 0 is the constant ψ₀ = 1. Channels count from 0. Raises ShapeError for unequal numbers or
    without words, RangeError for an empty word or a negative letter or channel.
    """

    words: tuple[Word, ...]
    channels: tuple[int, ...]

    def __post_init__(self) -> None:
        if len(self.words) != len(self.channels) or not self.words:
            raise ShapeError(
                f"{len(self.words)} words and {len(self.channels)} channels were given; give one channel per word,"
                " and at least one",
                "channels",
            )
        if any(not word or min(word) < 0 for word in self.words) or min(self.channels) < 0:
            raise RangeError("a word is empty or a letter or channel is negative; count letters from 0", "words")

    def __len__(self) -> int:
        return len(self.words)

    @cached_property
    def lengths(self) -> IntArray:
        """Letters of each word, (n,)."""
        return np.array([len(word) for word in self.words], dtype=np.int64)

    @cached_property
    def longest(self) -> int:
        """Letters of the longest word."""
        return max(map(len, self.words))

    @cached_property
    def _largest_letter(self) -> int:
        return max(map(max, self.words))

    @cached_property
    def _largest_channel(self) -> int:
        return max(self.channels)

    @cached_property
    def letters(self) -> dict[int, tuple[IntArray, IntArray, IntArray]]:
        """By length l of words: positions (m,) in the selection, letters (l, m) and channels (m,)."""
        found = {}
        for length in np.unique(self.lengths):
            at = np.flatnonzero(self.lengths == length)
            letters = np.array([self.words[i] for i in at], dtype=np.int64).T
            found[int(length)] = (at, letters, np.array([self.channels[i] for i in at], dtype=np.int64))
        return found

    def subset(self, positions: IntArray) -> "BasisSelection":
        """Those at `positions` (m,), in that order."""
        return BasisSelection(tuple(self.words[i] for i in positions), tuple(self.channels[i] for i in positions))

    def require_within(self, basis_functions: int, channels: int, field: str) -> None:
        """Raises RangeError when a letter is not below `basis_functions` or a channel not below `channels`."""
        if self._largest_letter >= basis_functions or self._largest_channel >= channels:
            raise RangeError(
                f"{field} name a basis function or channel that the system does not have: there are {basis_functions}"
                f" basis functions (with the constant) and {channels} channels, counted from 0",
                field,
            )


@lru_cache(maxsize=64)
def every_word(depth: int, basis_functions: int, channels: int) -> BasisSelection:
    """All words of one to `depth` letters out of `basis_functions` (the constant included), each with every channel.

    As rows they make the observability matrix 𝒪_depth, as columns the reachability matrix ℛ_depth
    [Cox2018, (10), (12)], up to order. Raises RangeError for a number below 1 or more than 20 000 rows.
    """
    if min(depth, basis_functions, channels) < 1:
        raise RangeError("depth, basis functions and channels must be at least 1", "depth")
    size = channels * sum(basis_functions**length for length in range(1, depth + 1))
    if size > 20_000:
        raise RangeError(
            f"words of up to {depth} letters out of {basis_functions} make {size} rows; lower the depth or select a"
            " basis",
            "depth",
        )
    words = [w for length in range(1, depth + 1) for w in product(range(basis_functions), repeat=length)]
    pairs = [(word, channel) for word in words for channel in range(channels)]
    return BasisSelection(tuple(word for word, _ in pairs), tuple(channel for _, channel in pairs))


@dataclass(frozen=True, eq=False)
class HankelBlocks:
    """What a basis-reduced realisation needs [Cox2018, (20)], for k = 1 + n_ψ basis functions.

    `hankel` ℋ_{ν,ς} = 𝒪_ν ℛ_ς (n_o, n_r); `shifted` 𝒪_ν A_k ℛ_ς (k, n_o, n_r); `from_input` 𝒪_ν B_k (k, n_o, n_u);
    `to_output` C_k ℛ_ς (k, n_y, n_r); `direct` D_k (k, n_y, n_u).
    """

    hankel: FloatArray
    shifted: FloatArray
    from_input: FloatArray
    to_output: FloatArray
    direct: FloatArray


class SubMarkovSource(Protocol):
    """Whatever gives sub-Markov parameters for selected rows (n_o) and columns (n_r) of the extended Hankel matrix."""

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς} = 𝒪_ν ℛ_ς, (n_o, n_r)."""

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation."""


@dataclass(frozen=True, eq=False)
class ExactSubMarkov:
    """The sub-Markov parameters of known matrices: a (k, n_x, n_x), b (k, n_x, n_u), c (k, n_y, n_x), d (k, n_y, n_u).

    𝒪_ν and ℛ_ς are built as in [Cox2018, (17), (19)] and multiplied as in (20).
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray

    def observability(self, rows: BasisSelection) -> FloatArray:
        """𝒪_ν, (n_o, n_x)."""
        rows.require_within(len(self.c), self.c.shape[1], "rows")
        found = np.empty((len(rows), self.a.shape[1]))
        for at, letters, channels in rows.letters.values():
            part = self.c[letters[0], channels]
            for letter in letters[1:]:
                part = np.einsum("mi,mij->mj", part, self.a[letter])
            found[at] = part
        return found

    def reachability(self, columns: BasisSelection) -> FloatArray:
        """ℛ_ς, (n_x, n_r)."""
        columns.require_within(len(self.b), self.b.shape[2], "columns")
        found = np.empty((self.a.shape[1], len(columns)))
        for at, letters, channels in columns.letters.values():
            part = self.b[letters[-1], :, channels]
            for letter in letters[-2::-1]:
                part = np.einsum("mij,mj->mi", self.a[letter], part)
            found[:, at] = part.T
        return found

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς}, (n_o, n_r)."""
        return self.observability(rows) @ self.reachability(columns)

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""
        return self.d

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation."""
        left, right = self.observability(rows), self.reachability(columns)
        return HankelBlocks(left @ right, left @ self.a @ right, left @ self.b, self.c @ right, self.d)


@dataclass(frozen=True, eq=False)
class SummedSubMarkov:
    """The sum of two sources: a model's own parameters and what correlation finds in its output error."""

    first: SubMarkovSource
    second: SubMarkovSource

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς}, (n_o, n_r)."""
        return self.first.hankel(rows, columns) + self.second.hankel(rows, columns)

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""
        return self.first.direct() + self.second.direct()

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation."""
        first, second = self.first.blocks(rows, columns), self.second.blocks(rows, columns)
        return HankelBlocks(
            first.hankel + second.hankel,
            first.shifted + second.shifted,
            first.from_input + second.from_input,
            first.to_output + second.to_output,
            first.direct + second.direct,
        )
