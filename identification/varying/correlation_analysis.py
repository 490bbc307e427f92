"""Sub-Markov parameters from records with white input and white scheduling, by correlation."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from identification.arrays import FloatArray, IntArray
from identification.errors import NotIdentifiableError, ShapeError
from identification.varying.sub_markov import BasisSelection, HankelBlocks


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
        signals = np.ascontiguousarray(self.input.T)
        centred = signals - signals.mean(axis=1, keepdims=True)
        variance = centred @ centred.T / len(self.input)
        if _singular(variance):
            raise NotIdentifiableError(
                "an input is constant or a combination of the others; excite every input on its own", "input"
            )
        return np.asarray(np.linalg.inv(variance) @ centred)

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
    All parameters between selected rows and columns come from one matrix product. Raises ShapeError for unequal
    lengths, NotIdentifiableError when the record is too short for the words.
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

    @cached_property
    def _scheduled_output(self) -> FloatArray:
        """ψ*_γ(t) y_i(t), (k n_y, N)."""
        return np.asarray((self._psi_dual[:, None] * self._output_rows).reshape(-1, len(self.output)))

    @property
    def _psi_dual(self) -> FloatArray:
        return self.excitation.psi_dual

    def hankel(self, rows: BasisSelection, columns: BasisSelection) -> FloatArray:
        """ℋ_{ν,ς}, (n_o, n_r)."""
        left, right = self._rows(rows), self._columns(columns)
        return self._means(left, right)[left.places][:, right.places]

    def direct(self) -> FloatArray:
        """D_k, (k, n_y, n_u)."""
        k, n = self._psi_dual.shape
        found = self._output_rows @ self.excitation.pulses.T / n
        return np.asarray(found.reshape(len(found), k, -1).transpose(1, 0, 2))

    def blocks(self, rows: BasisSelection, columns: BasisSelection) -> HankelBlocks:
        """All blocks of the basis-reduced realisation, those without A_k from one product."""
        left, right, k = self._rows(rows), self._columns(columns), len(self._psi_dual)
        means = self._means(left, right)
        return HankelBlocks(
            means[left.places][:, right.places],
            self._shifted(left, right) / (len(self.output) - rows.lengths[:, None] - columns.lengths),
            means[left.places, : len(self.excitation.pulses)].reshape(len(rows), k, -1).transpose(1, 0, 2),
            means[: len(self._scheduled_output), right.places].reshape(k, -1, len(columns)),
            self.direct(),
        )

    def _means(self, left: "_Sequences", right: "_Sequences") -> FloatArray:
        samples = len(self.output) + 1 - left.lengths[:, None] - right.lengths
        return np.asarray(left.values @ right.values[:, :-1].T / samples)

    def _shifted(self, left: "_Sequences", right: "_Sequences") -> FloatArray:
        """Sums for 𝒪_ν A_k ℛ_ς, (k, n_o, n_r), the prolonged columns held for one letter at a time."""
        rows, columns = left.values[left.places, 1:], right.values[right.places, :-2]
        found, longer = np.empty((len(self._psi_dual), len(rows), len(columns))), np.empty_like(columns)
        for part, psi in zip(found, self._psi_dual, strict=True):
            np.matmul(rows, np.multiply(psi[1:-1], columns, out=longer).T, out=part)
        return found

    def _rows(self, rows: BasisSelection) -> "_Sequences":
        """y_i(t+l) ψ*_γ(t+l) ψ*_{a₁}(t+l−1) ⋯ of words of l letters, t = 0 … N − 2, zero after the record's end."""
        psi, (k, n), first = self._psi_dual, self._psi_dual.shape, self._scheduled_output
        n_y = len(first) // k
        rows.require_within(k, n_y, "rows")
        self._require_samples(rows)
        found = _Sequences.room(first[:, 1:], rows)
        for length, (at, letters, channels) in rows.letters.items():
            start = letters[0] * n_y + channels
            if length == 1:
                found.places[at] = start
                continue
            part = first[start, length:]
            for delay in range(1, length):
                part *= psi[letters[delay], length - delay : n - delay]
            found.values[found.places[at], : n - length] = part
        return found

    def _columns(self, columns: BasisSelection) -> "_Sequences":
        """ψ*_{c₁}(t) ⋯ ψ*_{c_m}(t−m+1) u*_j(t−m+1), t = 0 … N − 1, zero where the record has not begun."""
        psi, (k, n), last = self._psi_dual, self._psi_dual.shape, self.excitation.pulses
        n_u = len(last) // k
        columns.require_within(k, n_u, "columns")
        self._require_samples(columns)
        found = _Sequences.room(last, columns)
        for length, (at, letters, channels) in columns.letters.items():
            end = letters[-1] * n_u + channels
            if length == 1:
                found.places[at] = end
                continue
            part = last[end, : n - length + 1]
            for delay in range(length - 1):
                part *= psi[letters[delay], length - 1 - delay : n - delay]
            found.values[found.places[at], length - 1 :] = part
        return found

    def _require_samples(self, words: BasisSelection) -> None:
        samples = len(self.output)
        if samples < 4 * (words.longest + 1):
            raise NotIdentifiableError(
                f"{samples} samples are too few for words of {words.longest} letters; record longer", "output"
            )


@dataclass(frozen=True, eq=False)
class _Sequences:
    """Those of all words of one letter, and after them those of the longer ones that are selected.

    `values` (words, samples), `lengths` letters of each word, `places` where those selected stand.
    """

    values: FloatArray
    lengths: IntArray
    places: IntArray

    @classmethod
    def room(cls, one_letter: FloatArray, words: BasisSelection) -> "_Sequences":
        """With zeros for the longer words."""
        ones = np.ones(len(one_letter), dtype=np.int64)
        if words.longest == 1:
            return cls(one_letter, ones, np.empty(len(words), dtype=np.int64))
        longer = words.lengths > 1
        lengths, places = np.concatenate([ones, words.lengths[longer]]), len(ones) - 1 + np.cumsum(longer)
        values = np.zeros((len(lengths), one_letter.shape[1]))
        values[: len(one_letter)] = one_letter
        return cls(values, lengths, places)


def _singular(moments: FloatArray) -> bool:
    scale = np.sqrt(np.diag(moments))
    if scale.min() <= 1e-12 * max(scale.max(), np.finfo(float).tiny):
        return True
    return bool(np.linalg.eigvalsh(moments / np.outer(scale, scale))[0] <= 1e-10)
