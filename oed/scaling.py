"""Units in which the design problem is well conditioned."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from identification.arrays import FloatArray
from identification.outcome import Outcome
from oed.hypothesis import Hypothesis
from oed.problem import DesignProblem
from oed.spectra.family import Block, Pricing
from oed.statement import Statement


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """The problem for the parameters basis⁻¹ (θ_G, …) of all hypotheses and energies in `unit`.

    There the information of flat spectra of energy one, together with the prior, is the unit matrix, and the largest
    eigenvalue of the targets is one.
    """

    original: DesignProblem
    statement: Statement
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
        """What the spectra tell about the parameters themselves, (K, K)."""
        inverse = np.linalg.inv(self.basis)
        total = np.sum([block.total(weight) for block, weight in zip(blocks, weights, strict=True)], axis=0)
        return np.asarray(self.unit * inverse.T @ total @ inverse)

    def priced(self, points: FloatArray) -> Pricing:
        """The family of the problem at other operating points (M, s), in the same units."""
        problem, subject = self.original, self.statement.subject
        return problem.family.pricing(subject, points, problem.band, problem.step).transformed(self.basis)


def scaled(problem: DesignProblem, statement: Statement, targets: FloatArray) -> ScaledProblem | Outcome:
    """The problem in good units for targets R_j (J, K, K), less what prior information covers already.

    An Outcome with advice when the operating points and frequencies cannot determine the parameters of a hypothesis,
    whatever the energy.
    """
    pricing = statement.pricing.within(problem.limits, problem.samples)
    flat = np.sum([block.information[0, 0] for block in pricing.flat()], axis=0)
    bases = []
    for one, rows in zip(statement.subject.hypotheses, statement.subject.slices, strict=True):
        basis = _basis(flat[rows, rows], statement.prior[rows, rows])
        if basis is None:
            return _undetermined(problem, one)
        bases.append(basis)
    whole = np.asarray(block_diag(*bases))
    matrices = whole.T @ targets @ whole
    unit = float(np.linalg.eigvalsh(matrices)[:, -1].max())
    return ScaledProblem(
        problem,
        statement,
        problem.points[pricing.places],
        pricing.transformed(whole),
        matrices / unit,
        pricing.limits(problem.limits, problem.samples) / unit,
        whole,
        unit,
    )


def _basis(flat: FloatArray, prior: FloatArray) -> FloatArray | None:
    """Coordinates in which flat spectra and the prior tell the same about everything; None where they tell nothing."""
    diagonal = np.sqrt(np.diagonal(flat))
    if np.any(diagonal <= 0):
        return None
    known = prior / np.outer(diagonal, diagonal)
    correlation = flat / np.outer(diagonal, diagonal)
    values, vectors = np.linalg.eigh(correlation + known / max(abs(known).max(), 1.0))
    if values[0] <= 1e-13 * values[-1]:
        return None
    return np.asarray(vectors / np.sqrt(values) / diagonal[:, None])


def _undetermined(problem: DesignProblem, one: Hypothesis) -> Outcome:
    if one.suspected is not None or one.rival is not None:
        return Outcome(
            "infeasible",
            "none of these experiments shows what is to be decided about an effect: the parameters of the model take up"
            " all that it changes; add operating points, levels or frequencies",
        )
    needed = max(problem.model.dependence.sizes[: problem.model.structure.n_plant])
    return Outcome(
        "infeasible",
        f"no input at these {len(problem.points)} operating points determines all parameters of the plant; at least"
        f" {needed} distinct operating points are needed, and enough frequencies in the band: add operating points,"
        " widen the band, or lower the orders",
    )
