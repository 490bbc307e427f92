"""Sub-Markov parameters from records with white input and white scheduling, by correlation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import NotIdentifiableError, ShapeError
from identification.sub_markov import BasisSelection, HankelBlocks


@dataclass(frozen=True, eq=False)
class WhiteExcitation:
    """Scheduling and input that are white, and the sequences dual to them.

        ψ* = (E ψψᵀ)⁻¹ ψ,   u* = (var u)⁻¹ (u − E u),   so that E ψ*ψᵀ = I and E u*uᵀ = I

    `psi` (N, k) basis functions along the scheduling, ψ₀ = 1 first; `input` (N, n_u). The moments are those of the
    sample. For zero-mean, mutually uncorrelated ψ_i the dual is ψ_i/σ_i², as in [Cox2018, (6)]; otherwise it takes out
    means and the dependence of the ψ_i on each other at one time. Raises ShapeError for unequal lengths and
    NotIdentifiableError for constant inputs or linearly dependent basis functions.
    """

    psi: FloatArray
    input: FloatArray

    def __post_init__(self) -> None:
        if len(self.psi) != len(self.input):
            raise ShapeError(
                f"{len(self.psi)} samples of scheduling and {len(self.input)} of the input were given", "input"
            )

    @cached_property
    def psi_dual(self) -> FloatArray:
        """ψ*, (k, N)."""
        moments = self.psi.T @ self.psi / len(self.psi)
        if _singular(moments):
            raise NotIdentifiableError(
                "the basis functions are linearly dependent along this scheduling signal (one may be constant); vary"
                " every scheduling variable or leave basis functions out",
                "scheduling",
            )
        return np.asarray(np.linalg.inv(moments) @ self.psi.T)

    @cached_property
    def input_dual(self) -> FloatArray:
        """u*, (n_u, N)."""
        centred = self.input - self.input.mean(axis=0)
        variance = centred.T @ centred / len(centred)
        if _singular(variance):
            raise NotIdentifiableError(
                "an input is constant or a combination of the others; excite every input on its own", "input"
            )
        return np.asarray(np.linalg.inv(variance) @ centred.T)

    @cached_property
    def pulses(self) -> FloatArray:
        """ψ*_β(t) u*_j(t), (k n_u, N)."""
        return np.asarray((self.psi_dual[:, None] * self.input_dual).reshape(-1, len(self.psi)))

    def fit(self, output: FloatArray) -> "CorrelatedSubMarkov":
        """The sub-Markov parameters of an output (N, n_y)."""
        return CorrelatedSubMarkov(self, output)


@dataclass(frozen=True, eq=False)
class CorrelatedSubMarkov:
    """Estimates of sub-Markov parameters by correlation of output, scheduling and input [Cox2018, (6)–(8)].

        Ĉ_{s₁}A_{s₂} ⋯ B_{s_n} = 1/(N−n+1) Σ_t y(t) ψ*_{s₁}(t) ψ*_{s₂}(t−1) ⋯ ψ*_{s_n}(t−n+1) u*(t−n+1)ᵀ

    `output` (N, n_y) from rest. Assumes u white (A2), ψ white and independent of u (A3), noise independent of both.
    All parameters with rows of one length come from one matrix product. Raises ShapeError for unequal lengths,
    NotIdentifiableError when the record is too short for the words.
    """

    excitation: WhiteExcitation
    output: FloatArray

    def __post_init__(self) -> None:
        if len(self.output) != len(self.excitation.psi):
            raise ShapeError(
                f"the output has {len(self.output)} samples, the scheduling {len(self.excitation.psi)}", "output"
            )

    @cached_property
    def _output_rows(self) -> FloatArray:
        return np.ascontiguousarray(self.output.T)

    @property
    def _psi_dual(self) -> FloatArray:
        return self.excitation.psi_dual

    @property
    def _input_dual(self) -> FloatArray:
        return self.excitation.input_dual

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς}, (n_o, n_r)."""
        return _products(self._rows(rows), self._columns(columns), rows, columns.lengths)

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""
        k, n = self._psi_dual.shape
        found = self._output_rows @ self.excitation.pulses.T / n
        return np.asarray(found.reshape(len(found), k, -1).transpose(1, 0, 2))

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation, the columns of them all side by side in the products."""
        left, right = self._rows(rows), self._columns(columns)
        n_r, n_u, (k, n) = len(columns), len(self._input_dual), self._psi_dual.shape
        beside = np.empty(((k + 1) * n_r + k * n_u, n))
        beside[:n_r] = right
        longer = beside[n_r : -k * n_u].reshape(k, n_r, n)
        longer[:, :, 0] = 0.0
        np.multiply(self._psi_dual[:, None, 1:], right[:, :-1], out=longer[:, :, 1:])
        beside[-k * n_u :] = self.excitation.pulses
        lengths = np.concatenate([columns.lengths, np.tile(columns.lengths + 1, k), np.ones(k * n_u, dtype=np.int64)])
        found = _products(left, beside, rows, lengths)
        return HankelBlocks(
            found[:, :n_r],
            found[:, n_r : -k * n_u].reshape(len(rows), k, n_r).transpose(1, 0, 2),
            found[:, -k * n_u :].reshape(len(rows), k, n_u).transpose(1, 0, 2),
            self._to_output(right, columns.lengths),
            self.direct(),
        )

    def _to_output(self, right: FloatArray, lengths: IntArray) -> FloatArray:
        """C_k ℛ_ς, (k, n_y, n_r)."""
        k, n = self._psi_dual.shape
        left = (self._psi_dual[:, None] * self._output_rows).reshape(-1, n)
        found = left[:, 1:] @ right[:, :-1].T / (n - lengths)
        return np.asarray(found.reshape(k, -1, len(right)))

    def _rows(self, rows: BasisSelection) -> FloatArray:
        """y_i(t) ψ*_{γ}(t) ψ*_{a₁}(t−1) ⋯, (n_o, N)."""
        rows.require_within(len(self._psi_dual), len(self._output_rows), "rows")
        self._require_samples(rows)
        return _delayed_products(self._psi_dual, self._output_rows, rows, at_end=False)

    def _columns(self, columns: BasisSelection) -> FloatArray:
        """ψ*_{c₁}(t) ⋯ ψ*_{c_m}(t−m+1) u*_j(t−m+1), (n_r, N), zero where the record has not begun."""
        columns.require_within(len(self._psi_dual), len(self._input_dual), "columns")
        self._require_samples(columns)
        return _delayed_products(self._psi_dual, self._input_dual, columns, at_end=True)

    def _require_samples(self, words: BasisSelection) -> None:
        longest, samples = int(words.lengths.max()), len(self.output)
        if samples < 4 * (longest + 1):
            raise NotIdentifiableError(
                f"{samples} samples are too few for words of {longest} letters; record longer", "output"
            )


def _products(left: FloatArray, right: FloatArray, rows: BasisSelection, lengths: IntArray) -> FloatArray:
    """Mean of left (n_o, N) at t times right (m, N) at t − l, l the length of the row: one product for each l."""
    n = right.shape[1]
    found = np.empty((len(left), len(right)))
    for length, (at, _, _) in rows.letters.items():
        part = left if len(at) == len(left) else left[at]
        found[at] = part[:, length:] @ right[:, : n - length].T / (n - length - lengths + 1)
    return found


def _delayed_products(psi: FloatArray, signal: FloatArray, words: BasisSelection, at_end: bool) -> FloatArray:
    n = psi.shape[1]
    found = np.zeros((len(words), n))
    for length, (at, letters, channels) in words.letters.items():
        last = length - 1
        part = signal[channels, : n - last] if at_end else signal[channels, last:]
        for delay, letter in enumerate(letters):
            part = part * psi[letter, last - delay : n - delay]
        found[at, last:] = part
    return found


def _singular(moments: FloatArray) -> bool:
    scale = np.sqrt(np.diag(moments))
    if scale.min() <= 1e-12 * max(scale.max(), np.finfo(float).tiny):
        return True
    return bool(np.linalg.eigvalsh(moments / np.outer(scale, scale))[0] <= 1e-10)
