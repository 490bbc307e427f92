"""Covariance of the local parameters at chosen operating points."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError
from identification.models.model import Model


@dataclass(frozen=True)
class LocalCovariance:
    """The largest covariance of the local parameters ζ(p): T(p) P_θ T(p)ᵀ ⪯ Σ at each chosen operating point p.

        P_θ⁻¹ ⪰ R = T(p)ᵀ Σ⁻¹ T(p)                                            [Ghosh2018, Section 3.1]

    Σ (n, n) concerns all entries of ζ, or, of size n_plant, those of G alone; its entries between G and H must be zero.
    """

    kind: ClassVar[str] = "local_covariance"

    operating_points: Annotated[tuple[tuple[float, ...], ...], "one row of scheduling variables a point"]
    covariance: Annotated[tuple[tuple[float, ...], ...], "Σ, rows of the largest covariance of ζ(p)"]

    def matrices(self, model: Model) -> FloatArray:
        """R_j (J, k, k), one per operating point; raises ShapeError and RangeError."""
        structure = model.structure
        sigma = np.array(self.covariance, dtype=np.float64) if _square(self.covariance) else np.zeros((0, 0))
        if len(sigma) not in (structure.n_plant, structure.size):
            raise ShapeError(
                f"the covariance must be square of size {structure.size} (or {structure.n_plant}, for G alone)",
                "covariance",
            )
        if np.any(sigma[: structure.n_plant, structure.n_plant :]) or not np.allclose(sigma, sigma.T):
            raise RangeError(
                "the covariance must be symmetric and zero between the coefficients of G and H", "covariance"
            )
        if np.linalg.eigvalsh(sigma)[0] <= 0:
            raise RangeError("the covariance must be positive definite", "covariance")
        transfer = model.dependence.matrix(np.array(self.operating_points, ndmin=2))[:, : len(sigma)]
        return np.asarray(np.swapaxes(transfer, 1, 2) @ np.linalg.inv(sigma) @ transfer)

    @classmethod
    def example(cls, model: Model) -> "LocalCovariance":
        """One per cent of each coefficient in the middle of the range, for the conformance tests."""
        middle = tuple((v.minimum + v.maximum) / 2 for v in model.dependence.variables)
        zeta = model.coefficients([middle])[0]
        return cls((middle,), tuple(map(tuple, np.diag((0.01 * np.maximum(abs(zeta), 0.1)) ** 2))))


def _square(rows: tuple[tuple[float, ...], ...]) -> bool:
    return all(len(row) == len(rows) for row in rows)
