"""A from the shift invariance of the observability matrix, and how it is kept stable."""

from typing import Literal

import numpy as np
from scipy.linalg import schur

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError

Transition = Literal["least_squares", "total_least_squares"]
Stability = Literal["none", "projection", "maciejowski"]

MARGIN = 1e-6


def transition_matrix(shifted_from: FloatArray, shifted_to: FloatArray, method: Transition) -> FloatArray:
    """A (n, n) of O_1 A ≈ O_2 for O_1, O_2 (R, n), R ≥ n.

    "least_squares" minimises ‖O_1 A − O_2‖; "total_least_squares" minimises ‖[N_1 N_2]‖ in (O_1 + N_1) A = O_2 + N_2:

        [O_1 O_2] = U S [V_11 V_12; V_21 V_22]ᵀ,   A = −V_12 V_22⁻¹     [Akcay2008, Alternative ways of calculating A]

    Raises NotIdentifiableError where O_1 is singular, or where no total least-squares solution exists.
    """
    n = shifted_from.shape[1]
    if method == "least_squares":
        solution, _, rank, _ = np.linalg.lstsq(shifted_from, shifted_to)
        regular = rank == n
    else:
        right = np.linalg.svd(np.concatenate([shifted_from, shifted_to], axis=1))[2].T[:, n:]
        regular = np.linalg.cond(right[n:]) < 1e12
        solution = -right[:n] @ np.linalg.inv(right[n:]) if regular else right
    if not regular:
        raise NotIdentifiableError("the data have no such order; choose a lower order or more block rows", "order")
    return np.asarray(solution)


def projected(a: FloatArray, margin: float = MARGIN) -> FloatArray:
    """A with every eigenvalue moved inside the unit circle that is not there by the margin [Akcay2008].

        λ ← λ min(2/|λ| − 1, (1 − margin)/|λ|) for 1 − margin < |λ| ≤ 2,   λ ← 0 for |λ| > 2

    (Guaranteeing stability, there for 1 ≤ |λ|; rounding decides on which side of the circle an eigenvalue on it comes
    out.) In the real Schur form, whose diagonal blocks are scaled, so that A stays real; others stay as they are.
    """
    triangle, basis = schur(a, output="real")
    i, moved = 0, False
    while i < len(a):
        size = 2 if i + 1 < len(a) and triangle[i + 1, i] != 0 else 1
        block = slice(i, i + size)
        modulus = float(abs(np.linalg.eigvals(triangle[block, block])).max())
        if modulus > 1 - margin:
            triangle[block, block] *= max(min(2 - modulus, 1 - margin), 0.0) / modulus
            moved = True
        i += size
    return np.asarray(basis @ triangle @ basis.T) if moved else a
