"""Units in which the design problem is well conditioned."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from identification.arrays import BoolArray, FloatArray, IntArray
from identification.outcome import Outcome
from oed.hypothesis import Hypothesis
from oed.pencil import Pencil
from oed.problem import DesignProblem
from oed.spectra.family import Block, Pricing
from oed.statement import Statement


@dataclass(frozen=True, eq=False)
class ScaledProblem:
    """The problem for x with θ = `basis` x (K, r), `coordinates` · basis = I (r, r), and energies in `unit`.

    There what flat spectra of energy one tell, together with the prior, is the unit matrix, and what the targets R_j
    ask for beyond the prior, `targets` (J, r, r), is at most that. What no experiment tells anything about, and no
    target asks for, is left out. `asking`: the numbers of the targets that the prior does not meet.
    """

    original: DesignProblem
    statement: Statement
    points: FloatArray
    pricing: Pricing
    targets: FloatArray
    asking: IntArray
    caps: FloatArray
    basis: FloatArray
    coordinates: FloatArray
    unit: float

    @property
    def tolerance(self) -> float:
        """Relative gap to be certified."""
        return self.original.tolerance

    def information(self, blocks: Sequence[Block], weights: Sequence[FloatArray]) -> FloatArray:
        """What the spectra tell about the parameters themselves, (K, K)."""
        total = np.sum([block.total(weight) for block, weight in zip(blocks, weights, strict=True)], axis=0)
        return np.asarray(self.unit * self.coordinates.T @ total @ self.coordinates)

    def inside(self, rows: slice) -> BoolArray:
        """Which coordinates (r,) belong to parameters in these rows of θ."""
        return np.asarray(np.any(self.basis[rows] != 0, axis=0))

    def priced(self, points: FloatArray) -> Pricing:
        """The family of the problem at other operating points (M, s), in the same units."""
        problem, subject = self.original, self.statement.subject
        return problem.family.pricing(subject, points, problem.band, problem.step).transformed(self.basis)


def scaled(problem: DesignProblem, statement: Statement, asking: IntArray) -> ScaledProblem | Outcome:
    """The problem in good units for the targets `asking`, less what prior information covers already.

    An Outcome with advice when the operating points and frequencies tell nothing, whatever the energy, about something
    that a target asks for.
    """
    pricing = statement.pricing.within(problem.limits, problem.samples)
    if problem.plant_limits:
        pricing = pricing.restricted(problem.share)
    flat = np.sum([block.information[0, 0] for block in pricing.flat()], axis=0)
    k = statement.plant
    targets, pencils, unit = statement.targets[asking, :k, :k], [], 0.0
    for one, rows in zip(statement.subject.hypotheses, statement.subject.slices, strict=True):
        pencil, asked = Pencil.of(statement.prior[rows, rows], flat[rows, rows]), targets[:, rows, rows]
        if pencil.unreached(asked).any():
            return _undetermined(problem, one)
        enough = pencil.enough(asked)
        if not np.isfinite(enough):
            return _undetermined(problem, one)
        pencils.append(pencil)
        unit = max(unit, enough)
    sizes = [np.sqrt((one.prior + unit * one.gain) / unit) for one in pencils]
    basis = np.asarray(block_diag(*(one.basis / size for one, size in zip(pencils, sizes, strict=True))))
    known = np.concatenate([one.prior / (one.prior + unit * one.gain) for one in pencils])
    return ScaledProblem(
        problem,
        statement,
        problem.points[pricing.places],
        pricing.transformed(basis, unit / problem.samples),
        basis.T @ targets @ basis / unit - np.diag(known),
        asking,
        pricing.limits(problem.limits, problem.samples) / unit,
        basis,
        np.asarray(block_diag(*(size[:, None] * one.coordinates for one, size in zip(pencils, sizes, strict=True)))),
        unit,
    )


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
