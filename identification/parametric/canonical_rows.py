"""The state basis that all operating points share: n rows of the observability matrix become the identity."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import comb

import numpy as np

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError, ShapeError

FEW = 3000
SINGULAR = 1e-12
LEAST_WEIGHT = 1e-4  # of the largest


@dataclass(frozen=True)
class CanonicalRows:
    """How many block rows of each output make the basis, (n_y,), and how well they do it.

    `indices`: the n rows, numbered from zero in block rows of n_y; `worst_singular_value`: the smallest singular value
    of S U over all operating points, U an orthonormal basis of the subspace; 1 is perfect, 0 fails.
    """

    counts: tuple[int, ...]
    indices: tuple[int, ...]
    worst_singular_value: float


def choose_rows(
    observabilities: Sequence[FloatArray], outputs: int, counts: Sequence[int] | None = None
) -> CanonicalRows:
    """The best conditioned choice S of n independent rows, the same for all O_m (q n_y, n) [Kergus2019, (13)].

    Each output gives its first rows without a gap, as the observability canonical forms do, so that a plant whose
    matrices in canonical form are sums of the basis functions stays one. All such choices are tried while they are few
    (so always with one output); otherwise rows are added one at a time, the best each time. `counts` states the choice.
    Raises ShapeError for stated counts that do not add up to n, NotIdentifiableError when every choice is singular
    somewhere.
    """
    bases = np.stack([np.linalg.qr(o)[0] for o in observabilities])
    order, blocks = bases.shape[2], bases.shape[1] // outputs
    if counts is not None:
        _require_counts(counts, order, blocks, outputs)
        value, counts = _worst(bases, counts), tuple(counts)
    elif comb(order + outputs - 1, outputs - 1) <= FEW:
        choices = [c for c in _compositions(order, outputs) if max(c) <= blocks]
        scored = [(_worst(bases, c), c) for c in choices]
        value, counts = max(scored)
    else:
        counts = _greedy(bases, outputs)
        value = _worst(bases, counts)
    if value < SINGULAR:
        raise NotIdentifiableError(
            f"no choice of {order} rows makes a basis of the state at all operating points (smallest singular value"
            f" {value:.1e}); choose a lower order",
            "order",
        )
    return CanonicalRows(counts, tuple(_rows(counts)), value)


def _require_counts(counts: Sequence[int], order: int, blocks: int, outputs: int) -> None:
    if len(counts) != outputs or sum(counts) != order or not all(0 <= count <= blocks for count in counts):
        raise ShapeError(
            f"rows per output {tuple(counts)} do not make a basis of {order} states with {outputs} outputs; give one"
            f" count per output, {order} in all, none above {blocks}",
            "rows_per_output",
        )


def canonical(observability: FloatArray, rows: CanonicalRows) -> FloatArray:
    """O (S O)⁻¹."""
    return np.asarray(np.linalg.solve(observability[list(rows.indices)].T, observability.T).T)


def misfit_weight(
    observabilities: Sequence[FloatArray], singular_values: Sequence[FloatArray], rows: CanonicalRows
) -> FloatArray:
    """M (n, n) of M Mᵀ = Σ S O_m Σ_m² (S O_m)ᵀ: a residual times M counts directions of the state as they show.

    Noise turns the i-th singular vector by an angle that is inverse to its singular value.
    """
    factors = [
        o[list(rows.indices)] * values[: o.shape[1]] for o, values in zip(observabilities, singular_values, strict=True)
    ]
    left, sizes, _ = np.linalg.svd(np.hstack(factors), full_matrices=False)
    return np.asarray(left * np.maximum(sizes, LEAST_WEIGHT * sizes[0]))


def _compositions(order: int, outputs: int) -> Iterator[tuple[int, ...]]:
    """All ways to write n as a sum of n_y counts ≥ 0."""
    for bars in combinations(range(order + outputs - 1), outputs - 1):
        edges = (-1, *bars, order + outputs - 1)
        yield tuple(b - a - 1 for a, b in pairwise(edges))


def _rows(counts: Sequence[int]) -> list[int]:
    """The rows of a choice, block row after block row."""
    return sorted(k * len(counts) + y for y, count in enumerate(counts) for k in range(count))


def _worst(bases: FloatArray, counts: Sequence[int]) -> float:
    return float(np.linalg.svd(bases[:, _rows(counts)], compute_uv=False)[:, -1].min())


def _greedy(bases: FloatArray, outputs: int) -> tuple[int, ...]:
    counts = [0] * outputs
    for _ in range(bases.shape[2]):
        trials = [[*counts[:y], counts[y] + 1, *counts[y + 1 :]] for y in range(outputs)]
        counts = max((t for t in trials if max(t) * outputs <= bases.shape[1]), key=lambda t: _worst(bases, t))
    return tuple(counts)
