"""The master problem where every spectrum tells little more than one direction, by a method on Gram matrices."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve, cholesky

from identification.arrays import FloatArray, IntArray
from oed.spectra.family import Block

MOST_STEPS = 60
STEP = 0.9
START = 2.0
LEAST_STEP = 1e-6
MOST_STEP = 1.2
SHIFT = 1e-14


@dataclass(frozen=True, eq=False)
class LowRankSolution:
    """Weights w (n,), prices Z (J, k, k), and whether the gap between both came below the accuracy asked for."""

    weights: FloatArray
    prices: FloatArray
    solved: bool


def solve_low_rank(blocks: Sequence[Block], targets: FloatArray, accuracy: float) -> LowRankSolution:
    """The least energy over single spectra that tell A_i = B_i B_iᵀ, for targets R_j (J, k, k).

        primal  min Σ w_i   s.t.  S_j = Σ_i w_i A_i − R_j ⪰ 0,  w ≥ 0
        dual    max Σ_j tr R_j Z_j   s.t.  s_i = 1 − Σ_j tr A_i Z_j ≥ 0,  Z_j ⪰ 0

    Both start feasible and stay so, hence Σ w − Σ tr R_j Z_j = w·s + Σ tr S_j Z_j. A step in the direction of Nesterov
    and Todd [ToddTohTutuncu1998, Section 3], with Mehrotra's predictor and corrector, solves M dw = r with

        M_il = Σ_j Σ over the squared entries of (G_j⁻¹ B_i)ᵀ (G_j⁻¹ B_l)  +  δ_il s_i/w_i,   G⁻¹ S G⁻ᵀ = Gᵀ Z G = D

    which takes one Gram matrix a target and one Cholesky factor of size n, where the general conic solver factors the
    k²/2 rows of the inequality. Where the parameters fall into parts of which the information is block diagonal, each
    is a matrix inequality of its own.
    """
    state = _State.start(_Columns.of(blocks), targets)
    for _ in range(MOST_STEPS):
        if state.gap <= accuracy * max(1.0, float(state.w.sum())):
            return LowRankSolution(state.w, state.prices(targets.shape), True)
        further = state.stepped()
        if further is None:
            break
        state = further
    return LowRankSolution(state.w, state.prices(targets.shape), state.gap <= 1e-3 * float(state.w.sum()))


@dataclass(frozen=True, eq=False)
class _Columns:
    """For each part its rows and the columns B (k_part, N) of all spectra side by side; `starts` (n,) of each."""

    parts: tuple[tuple[slice, FloatArray, IntArray], ...]
    count: int

    @classmethod
    def of(cls, blocks: Sequence[Block]) -> "_Columns":
        parts = []
        for rows in blocks[0].parts:
            own = [block.factor(rows) for block in blocks]
            starts = np.cumsum([0, *(factor.shape[1] for factor in own[:-1])])
            parts.append((rows, np.hstack(own), starts))
        return cls(tuple(parts), len(blocks))

    def total(self, part: int, w: FloatArray) -> FloatArray:
        """Σ w_i A_i of a part."""
        _, columns, starts = self.parts[part]
        widths = np.diff(np.append(starts, columns.shape[1]))
        return np.asarray((columns * np.repeat(w, widths)) @ columns.T)

    def scaled(self, part: int, inverse: FloatArray) -> FloatArray:
        """G⁻¹ B of a part."""
        return np.asarray(inverse @ self.parts[part][1])

    def worth(self, part: int, columns: FloatArray, matrix: FloatArray) -> FloatArray:
        """tr B_iᵀ X B_i for a symmetric X and the columns B of a part, (n,)."""
        return np.asarray(np.add.reduceat(np.einsum("kn,kn->n", columns, matrix @ columns), self.parts[part][2]))

    def schur(self, part: int, scaled: Sequence[FloatArray]) -> FloatArray:
        """Σ over the squared entries of B_iᵀ B_l, (n, n), summed over the columns B of the cones of a part."""
        starts, columns = self.parts[part][2], scaled[0]
        squares = np.zeros((columns.shape[1],) * 2)
        for each in scaled:
            gram = each.T @ each
            gram *= gram
            squares += gram
        if len(starts) == columns.shape[1]:
            return np.asarray(squares)
        return np.asarray(np.add.reduceat(np.add.reduceat(squares, starts, axis=0), starts, axis=1))


@dataclass(frozen=True, eq=False)
class _Cone:
    """One matrix inequality: its part, R, S = Σ w A − R and Z."""

    part: int
    target: int
    asked: FloatArray
    S: FloatArray
    Z: FloatArray


@dataclass(frozen=True, eq=False)
class _State:
    """A feasible pair (w, S) and (s, Z)."""

    columns: _Columns
    w: FloatArray
    s: FloatArray
    cones: tuple[_Cone, ...]

    @classmethod
    def start(cls, columns: _Columns, targets: FloatArray) -> "_State":
        """Large weights, and small prices that are central with them."""
        ones = np.ones(columns.count)
        pairs = [(part, j) for part in range(len(columns.parts)) for j in range(len(targets))]
        totals = [columns.total(part, ones) for part in range(len(columns.parts))]
        scale = 0.0
        for part, j in pairs:
            rows = columns.parts[part][0]
            values, vectors = np.linalg.eigh(totals[part])
            root = vectors / np.sqrt(np.maximum(values, SHIFT * values[-1]))
            scale = max(scale, float(np.linalg.eigvalsh(root.T @ targets[j][rows, rows] @ root)[-1]))
        w = START * max(scale, 1e-12) * ones
        asked = [targets[j][columns.parts[part][0], columns.parts[part][0]] for part, j in pairs]
        slack = [w[0] * totals[part] - R for (part, _), R in zip(pairs, asked, strict=True)]
        inverses = [np.linalg.inv(S) for S in slack]
        worth = np.sum(
            [columns.worth(part, columns.parts[part][1], X) for (part, _), X in zip(pairs, inverses, strict=True)],
            axis=0,
        )
        z = 0.5 / float(worth.max())
        whole = zip(pairs, asked, slack, inverses, strict=True)
        cones = tuple(_Cone(part, j, R, S, z * _symmetric(X)) for (part, j), R, S, X in whole)
        return cls(columns, w, 1 - z * worth, cones)

    @property
    def gap(self) -> float:
        """Σ w − Σ tr R Z."""
        return float(self.w @ self.s + sum(np.sum(cone.S * cone.Z) for cone in self.cones))

    @property
    def size(self) -> int:
        """The number of complementary pairs."""
        return len(self.w) + sum(len(cone.S) for cone in self.cones)

    def prices(self, shape: tuple[int, ...]) -> FloatArray:
        """Z (J, k, k)."""
        result = np.zeros(shape)
        for cone in self.cones:
            rows = self.columns.parts[cone.part][0]
            result[cone.target, rows, rows] = cone.Z
        return result

    def stepped(self) -> "_State | None":
        """After one step of predictor and corrector; None where rounding leaves no way."""
        try:
            newton = _Newton.of(self)
        except LinAlgError:
            return None
        mu = self.gap / self.size
        predicted = newton.direction(0.0, None)
        ahead = self._moved(predicted, *newton.lengths(predicted)).gap / self.size
        corrected = newton.direction(mu * min((ahead / mu) ** 3, 1.0), predicted)
        lengths = newton.lengths(corrected)
        if max(lengths) < LEAST_STEP:
            return None
        reach = STEP + (1 - STEP) * 0.9 * min(*lengths, 1.0)
        return self._moved(corrected, min(reach * lengths[0], 1.0), min(reach * lengths[1], 1.0))

    def _moved(self, direction: "_Direction", primal: float, dual: float) -> "_State":
        cones = tuple(
            _Cone(cone.part, cone.target, cone.asked, cone.S + primal * dS, cone.Z + dual * dZ)
            for cone, dS, dZ in zip(self.cones, direction.of_slack, direction.of_price, strict=True)
        )
        return _State(self.columns, self.w + primal * direction.dw, self.s + dual * direction.ds, cones)


@dataclass(frozen=True, eq=False)
class _Direction:
    """Changes of w, s, S and Z; `scaled`: G⁻¹ dS G⁻ᵀ and Gᵀ dZ G of each cone."""

    dw: FloatArray
    ds: FloatArray
    of_slack: tuple[FloatArray, ...]
    of_price: tuple[FloatArray, ...]
    scaled: tuple[tuple[FloatArray, FloatArray], ...]


@dataclass(frozen=True, eq=False)
class _Newton:
    """A state with its scaled cones (G⁻¹, diagonal of D, G⁻¹ B) and the factored Schur complement."""

    state: _State
    cones: tuple[tuple[FloatArray, FloatArray, FloatArray], ...]
    factor: tuple[FloatArray, bool]

    @classmethod
    def of(cls, state: _State) -> "_Newton":
        cones, matrix = [], np.diag(state.s / state.w)
        for cone in state.cones:
            root = cholesky(cone.Z, lower=True)
            left, values, _ = np.linalg.svd(root.T @ cholesky(cone.S, lower=True))
            inverse = (left / np.sqrt(values)).T @ root.T
            columns = state.columns.scaled(cone.part, inverse)
            cones.append((inverse, values, columns))
        for part in range(len(state.columns.parts)):
            pairs = zip(state.cones, cones, strict=True)
            matrix += state.columns.schur(part, [own for cone, (_, _, own) in pairs if cone.part == part])
        matrix[np.diag_indices_from(matrix)] *= 1 + SHIFT
        return cls(state, tuple(cones), cho_factor(matrix, lower=True))

    def direction(self, mu: float, predicted: _Direction | None) -> _Direction:
        """G⁻¹ dS G⁻ᵀ + Gᵀ dZ G = 2 (μ I − D² − sym(product of the predicted changes))_ab / (d_a + d_b)."""
        state, columns = self.state, self.state.columns
        right, sums = mu / state.w - state.s, []
        if predicted is not None:
            right = right - predicted.dw * predicted.ds / state.w
        for number, (cone, (_, values, own)) in enumerate(zip(state.cones, self.cones, strict=True)):
            missing = np.diag(mu - values**2)
            if predicted is not None:
                missing = missing - _symmetric(predicted.scaled[number][0] @ predicted.scaled[number][1])
            sums.append(2 * missing / np.add.outer(values, values))
            right = right + columns.worth(cone.part, own, sums[-1])
        dw = np.asarray(cho_solve(self.factor, right))
        totals = [columns.total(part, dw) for part in range(len(columns.parts))]
        dS = tuple(totals[cone.part] for cone in state.cones)
        scaled, dZ, ds = [], [], np.zeros_like(dw)
        for cone, change, total, (inverse, _, own) in zip(state.cones, dS, sums, self.cones, strict=True):
            first = _symmetric(inverse @ change @ inverse.T)
            scaled.append((first, total - first))
            dZ.append(_symmetric(inverse.T @ (total - first) @ inverse))
            ds -= columns.worth(cone.part, own, total - first)
        return _Direction(dw, ds, dS, tuple(dZ), tuple(scaled))

    def lengths(self, direction: _Direction) -> tuple[float, float]:
        """How far the primal and the dual may go until something turns negative."""
        primal = [_longest(self.state.w, direction.dw), MOST_STEP]
        dual = [_longest(self.state.s, direction.ds), MOST_STEP]
        for (_, values, _), (first, second) in zip(self.cones, direction.scaled, strict=True):
            scale = np.sqrt(np.outer(values, values))
            primal.append(_until_singular(first / scale))
            dual.append(_until_singular(second / scale))
        return min(primal), min(dual)


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray((matrix + matrix.T) / 2)


def _longest(values: FloatArray, changes: FloatArray) -> float:
    falling = changes < 0
    return float(np.min(-values[falling] / changes[falling], initial=np.inf))


def _until_singular(change: FloatArray) -> float:
    """The longest step from the unit matrix."""
    least = float(np.linalg.eigvalsh(change)[0])
    return -1 / least if least < 0 else np.inf
