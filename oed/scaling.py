"""Units in which the design problem is well conditioned."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.arrays import FloatArray
from identification.outcome import Outcome
from oed.problem import DesignProblem
from oed.spectra.family import Block, Pricing


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """The problem for the parameters basis⁻¹ θ_G and energies in `unit`.

    There the information of flat spectra of energy one, together with the prior, is the unit matrix, and the largest
    eigenvalue of the targets is one.
    """

    original: DesignProblem
    points: FloatArray
    pricing: Pricing
    targets: FloatArray
    caps: FloatArray
    basis: FloatArray
    unit: float

    @property
    def tolerance(self) -> float:
        """Relative gap to be certified."""
        return self.original.tolerance

    def information(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FloatArray:
        """What the spectra tell about θ_G itself, (k_G, k_G)."""
        inverse = np.linalg.inv(self.basis)
        total = np.sum([block.total(weight) for block, weight in zip(blocks, weights, strict=True)], axis=0)
        return np.asarray(self.unit * inverse.T @ total @ inverse)

    def priced(self, points: FloatArray) -> Pricing:
        """The family of the problem at other operating points (M, s), in the same units."""
        problem = self.original
        return problem.family.pricing(problem.model, points, problem.band, problem.step).transformed(self.basis)


def scaled(problem: DesignProblem, targets: FloatArray) -> ScaledProblem | Outcome:
    """The problem in good units for targets R_j (J, k_G, k_G), less what prior information covers already.

    An Outcome with advice when the operating points and frequencies cannot determine θ_G, whatever the energy.
    """
    pricing = problem.family.pricing(problem.model, problem.points, problem.band, problem.step)
    k = problem.model.plant_size
    flat = np.sum([block.information[0, 0] for block in pricing.flat()], axis=0)
    diagonal = np.sqrt(np.diagonal(flat))
    if np.any(diagonal <= 0):
        return _undetermined(problem)
    prior = problem.prior[:k, :k] / np.outer(diagonal, diagonal)
    correlation = flat / np.outer(diagonal, diagonal)
    values, vectors = np.linalg.eigh(correlation + prior / max(abs(prior).max(), 1.0))
    if values[0] <= 1e-13 * values[-1]:
        return _undetermined(problem)
    basis = vectors / np.sqrt(values) / diagonal[:, None]
    matrices = basis.T @ targets @ basis
    unit = float(np.linalg.eigvalsh(matrices)[:, -1].max())
    return ScaledProblem(
        problem, problem.points, pricing.transformed(basis), matrices / unit, problem.limits / unit, basis, unit
    )


def _undetermined(problem: DesignProblem) -> Outcome:
    needed = max(problem.model.dependence.sizes[: problem.model.structure.n_plant])
    return Outcome(
        "infeasible",
        f"no input at these {len(problem.points)} operating points determines all parameters of the plant; at least"
        f" {needed} distinct operating points are needed, and enough frequencies in the band: add operating points,"
        " widen the band, or lower the orders",
    )
