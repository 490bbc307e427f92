"""Parameter-varying models from local models, the two-step estimate with the least variance."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.linalg import qr, solve_triangular

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, ShapeError
from identification.estimates import Estimate, LocalEstimate
from identification.lpv.stacking import (
    asymptotics_advice,
    instability_advice,
    place,
    prior_rows,
    stacked_points,
    whitener,
)
from identification.lti.whiteness import chi_square
from identification.models.model import Model
from identification.models.physical import RationalForm
from identification.outcome import Outcome, TestResult
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse, Measurement, require_one_channel


@dataclass(frozen=True)
class GeneralisedLeastSquares:
    """The estimate of θ with the least variance given local estimates ζ̂_m [Ghosh2018, Theorem 1].

        θ̂ = (Σ T_mᵀ P_m⁻¹ T_m)⁻¹ Σ T_mᵀ P_m⁻¹ ζ̂_m,   P_θ = (Σ T_mᵀ P_m⁻¹ T_m)⁻¹        (9), (10)

    computed by orthogonal transformation of the white rows S 𝒯 θ = S ζ̂, P_ζ⁻¹ = SᵀS, as in (11), (12). σ̂_e² is the
    mean of the local ones [Ghosh2018, Section 4].
    """

    kind: ClassVar[str] = "generalised_least_squares"

    def estimate(
        self,
        structure: RationalForm,
        dependence: ParameterDependence,
        experiments: Sequence[Measurement],
        local: Sequence[LocalEstimate],
        prior: Model | None = None,
    ) -> Estimate:
        """The parameter-varying model of M experiments and their local estimates, in the same order.

        `prior`, an estimate from other experiments, is combined with these as in [Ghosh2018, (13)]. The tests hold the
        residual S (ζ̂ − 𝒯 θ̂) against χ²(nM − k) [Ghosh2018, Remark 3], over all, coefficient by coefficient, and by
        operating point against what the others predict. The outcome warns of short records (Remark 1) and is
        "infeasible" when the model is unstable at an operating point of the experiments.
        Raises TooFewOperatingPointsError, NotIdentifiableError (a local estimate that its data do not determine),
        MisuseError or ShapeError.
        """
        points = stacked_points(structure, dependence, experiments, prior)
        _require_usable(structure, experiments, local)
        transfer = dependence.matrix(points)
        stack = _stack(transfer, local, prior)
        theta, covariance = stack.solve()
        noise_variance = float(np.mean([estimate.model.noise_variance for estimate in local]))
        model = Model(structure, dependence, theta, covariance, noise_variance)
        tests = (stack.overall(theta), *_by_coefficient(structure, dependence, points, local), *stack.by_point(theta))
        return Estimate(model, _outcome(model, points, experiments), tests, tuple(local))

    @classmethod
    def example(cls) -> "GeneralisedLeastSquares":
        """A small one, for the conformance tests."""
        return cls()


@dataclass(frozen=True, eq=False)
class _Stack:
    """White rows: S_m T_m and S_m ζ̂_m of every experiment, then those of the prior estimate."""

    rows: FloatArray
    values: FloatArray
    names: tuple[str, ...]
    block: int

    def _factor(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        scale = np.linalg.norm(self.rows, axis=0)
        q, r = qr(self.rows / scale, mode="economic")
        diagonal = abs(np.diag(r))
        if diagonal.min() <= 1e-12 * diagonal.max():
            raise NotIdentifiableError(
                "the operating points and accuracies do not determine all parameters; measure at more operating points"
                " or choose basis functions of lower order",
                "operating_points",
            )
        return q, r, scale

    def solve(self) -> tuple[FloatArray, FloatArray]:
        """θ̂ (k,) and P_θ (k, k)."""
        q, r, scale = self._factor()
        inverse = solve_triangular(r, np.eye(len(r))) / scale[:, None]
        return inverse @ (q.T @ self.values), inverse @ inverse.T

    def overall(self, theta: FloatArray) -> TestResult:
        """‖S (ζ̂ − 𝒯 θ̂)‖² ~ χ²(nM − k); with no degree of freedom left it is zero and says nothing."""
        residual = self.values - self.rows @ theta
        freedom = len(self.values) - len(theta)
        name = "dependence on the operating point"
        return chi_square(name, float(residual @ residual), freedom) if freedom else TestResult(name, 0.0, 0.0, 1.0)

    def by_point(self, theta: FloatArray) -> tuple[TestResult, ...]:
        """e_mᵀ (I − H_m)⁺ e_m ~ χ²(rank), e_m the residual of one experiment and H_m its block of the hat matrix."""
        q = self._factor()[0]
        residual = self.values - self.rows @ theta
        tests = []
        for m, name in enumerate(self.names):
            part = slice(m * self.block, (m + 1) * self.block)
            values, vectors = np.linalg.eigh(np.eye(self.block) - q[part] @ q[part].T)
            free = values > 1e-8
            if np.any(free):
                along = vectors[:, free].T @ residual[part]
                statistic = float(np.sum(along**2 / values[free]))
                tests.append(chi_square(f"agreement of {name} with the others", statistic, int(free.sum())))
        return tuple(tests)


def _stack(transfer: FloatArray, local: Sequence[LocalEstimate], prior: Model | None) -> _Stack:
    roots = [_root(estimate) for estimate in local]
    prior_part, prior_values = prior_rows(prior, transfer.shape[-1])
    rows = np.concatenate([*(root @ matrix for root, matrix in zip(roots, transfer, strict=True)), prior_part])
    values = [root @ estimate.model.zeta for root, estimate in zip(roots, local, strict=True)]
    names = tuple(place(estimate.model.operating_point) for estimate in local)
    return _Stack(rows, np.concatenate([*values, prior_values]), names, transfer.shape[1])


def _root(estimate: LocalEstimate) -> FloatArray:
    try:
        return whitener(estimate.model.covariance)
    except NotIdentifiableError as error:
        raise _not_determined(estimate) from error


def _not_determined(estimate: LocalEstimate) -> NotIdentifiableError:
    return NotIdentifiableError(
        f"the experiment at {place(estimate.model.operating_point)} does not determine a local model of its own"
        f" ({estimate.outcome.advice or 'its covariance is not positive definite'}); use the joint likelihood, which"
        " estimates θ from all experiments at once, or leave this experiment out",
        "experiments",
    )


def _require_usable(
    structure: RationalForm, experiments: Sequence[Measurement], local: Sequence[LocalEstimate]
) -> None:
    if len(local) != len(experiments):
        raise ShapeError(
            f"{len(local)} local estimates were given for {len(experiments)} experiments; give one each", "local"
        )
    for estimate, experiment in zip(local, experiments, strict=True):
        require_one_channel(experiment)
        if estimate.model.structure != structure or estimate.model.operating_point != experiment.operating_point:
            raise MisuseError(
                f"the local estimate at {place(estimate.model.operating_point)} has another structure or operating"
                f" point than its experiment at {place(experiment.operating_point)}",
                "local",
            )
        if estimate.outcome.status == "not_identifiable":
            raise _not_determined(estimate)
        if structure.n_noise and isinstance(experiment, FrequencyResponse):
            raise NotIdentifiableError(
                f"the frequency response at {place(experiment.operating_point)} says nothing about H; leave C and D out"
                " (n_c = n_d = 0) or use the joint likelihood with time records at other operating points",
                "structure",
            )


def _by_coefficient(
    structure: RationalForm,
    dependence: ParameterDependence,
    points: FloatArray,
    local: Sequence[LocalEstimate],
) -> tuple[TestResult, ...]:
    """Each coefficient fitted on its own with its own variances, ~ χ²(M − number of its basis functions)."""
    zeta = np.array([estimate.model.zeta for estimate in local])
    deviations = np.sqrt([np.diag(estimate.model.covariance) for estimate in local])
    tests = []
    for i, (name, basis) in enumerate(zip(structure.coefficient_names, dependence.bases, strict=True)):
        freedom = len(local) - basis.size
        if freedom > 0:
            rows = basis.evaluate(points, dependence.variables) / deviations[:, i, None]
            values = zeta[:, i] / deviations[:, i]
            residual = values - rows @ np.linalg.lstsq(rows, values)[0]
            statistic = float(residual @ residual)
            tests.append(chi_square(f"dependence of {name} on the operating point", statistic, freedom))
    return tuple(tests)


def _outcome(model: Model, points: FloatArray, experiments: Sequence[Measurement]) -> Outcome:
    unstable = instability_advice(model.structure, model.coefficients(points), points)
    if unstable:
        return Outcome("infeasible", unstable, 1)
    return Outcome("converged", asymptotics_advice(model.structure, experiments), 1)
