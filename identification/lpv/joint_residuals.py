"""The residuals of all experiments as functions of θ, and the variances that make them white."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from identification.arrays import FloatArray
from identification.errors import NotIdentifiableError, RangeError
from identification.least_squares import LeastSquaresSolution
from identification.lpv.stacking import prior_rows
from identification.lti.free_noise import RecordInLoop, errors_in_loop
from identification.lti.initial_conditions import InitialConditions, errors_from, free_parameters, level_errors
from identification.lti.likelihood import prediction_errors, response_errors
from identification.lti.response_tests import real_count, variance_inflation
from identification.models.model import Model
from identification.models.physical import RationalForm
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, Measurement, TimeRecord

SETTLING = 40


@dataclass(frozen=True, eq=False)
class JointResiduals:
    """Residuals of M experiments for T(p_m) (M, n, k), followed by the rows of a prior estimate.

    Experiments of unknown variance belong to groups that share one; a group's name tells which. Records are those of
    `identification.lti.initial_conditions.fitted_record`, whose structure is `structure_of_records`.
    """

    structure: RationalForm
    transfer: FloatArray
    experiments: tuple[Measurement, ...]
    prior: Model | None
    initial: InitialConditions
    common: bool
    relative: bool

    @cached_property
    def structure_of_records(self) -> RationalStructure:
        """The structure without the delay that the records have been moved by."""
        plain = self.structure.plain
        return replace(plain, n_k=0) if self.initial == "estimate" else plain

    @cached_property
    def group_of(self) -> tuple[str | None, ...]:
        """The group of each experiment, None where the variance is known."""
        return tuple(self._group(m, experiment) for m, experiment in enumerate(self.experiments))

    def _group(self, m: int, experiment: Measurement) -> str | None:
        if isinstance(experiment, TimeRecord):
            return "records" if self.common and not isinstance(experiment, RecordInLoop) else f"record {m}"
        return "responses" if experiment.variance is None else None

    @property
    def groups(self) -> tuple[str, ...]:
        """The names of the groups."""
        return tuple(dict.fromkeys(group for group in self.group_of if group is not None))

    @cached_property
    def _prior(self) -> tuple[FloatArray, FloatArray]:
        return prior_rows(self.prior, self.transfer.shape[-1])

    @cached_property
    def counts(self) -> FloatArray:
        """How many values each experiment has, less those that its unknown initial state takes up, (M,)."""
        return np.array([self._count(e) for e in self.experiments], dtype=np.float64)

    def _count(self, data: Measurement) -> int:
        if isinstance(data, TimeRecord):
            return len(data) - free_parameters(self.structure_of_records, self.initial, data)
        return real_count(data)

    def require_enough(self) -> None:
        """Raises NotIdentifiableError when there are not more values than parameters."""
        rows, k = int(self.counts.sum()) + len(self._prior[0]), self.transfer.shape[-1]
        if rows < k + (1 if self.groups else 0) or self.counts.min() < 1:
            raise NotIdentifiableError(
                f"{rows} values cannot determine {k} parameters and their accuracy; measure longer or at more"
                " frequencies and operating points, or choose lower orders",
                "experiments",
            )
        zeros = [e for e in self.experiments if isinstance(e, FrequencyResponse) and not np.all(e.response)]
        if self.relative and any(e.variance is None for e in zeros):
            raise RangeError("a response is zero at a frequency; use absolute errors", "unknown_variance")
        if not any(np.any(e.output if isinstance(e, TimeRecord) else e.response) for e in self.experiments):
            raise NotIdentifiableError("all outputs are zero throughout, nothing can be learnt from them", "output")

    def stable(self, theta: FloatArray) -> bool:
        """Whether the model is stable at every operating point of the experiments that no controller needs to hold."""
        alone = [not isinstance(one, RecordInLoop) for one in self.experiments]
        return bool(np.all(self.structure.stable(self.transfer[alone] @ theta)))

    def local(self, m: int, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """r_m (R,) and ∂r_m/∂ζ (R, n) of one experiment, not weighted by unknown variances."""
        zeta, data = self.transfer[m] @ theta, self.experiments[m]
        if isinstance(data, TimeRecord):
            return errors_from(self.structure_of_records, zeta, data, self.initial)
        if data.variance is None and self.relative:
            return response_errors(self.structure, zeta, data, 1 / abs(data.response))
        return response_errors(self.structure, zeta, data)

    def _disturbance(self, m: int, theta: FloatArray) -> float:
        data = self.experiments[m]
        assert isinstance(data, RecordInLoop)
        found = errors_in_loop(self.structure_of_records, self.transfer[m] @ theta, data)
        return float(np.mean(found.disturbance**2))

    def deviation(self, m: int, variances: Mapping[str, float]) -> float:
        """s_m: the root of the group's variance, or what the uncertainty of a stated variance demands."""
        group, data = self.group_of[m], self.experiments[m]
        if group is not None:
            return float(np.sqrt(variances[group]))
        assert isinstance(data, FrequencyResponse)
        return float(np.sqrt(variance_inflation(data.variance_degrees_of_freedom)))

    def white(self, theta: FloatArray, variances: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
        """All residuals over their standard deviations, (R,), and their derivatives with respect to θ, (R, k)."""
        residuals, jacobians = [], []
        for m, transfer in enumerate(self.transfer):
            residual, jacobian = self.local(m, theta)
            deviation = self.deviation(m, variances)
            residuals.append(residual / deviation)
            jacobians.append(jacobian @ (transfer / deviation))
        root, target = self._prior
        return np.concatenate([*residuals, root @ theta - target]), np.concatenate([*jacobians, root])

    def settled_jacobian(self, theta: FloatArray, variances: Mapping[str, float]) -> FloatArray:
        """Derivatives as in `white` for a model with fast poles, without the responses to initial states, (R, k)."""
        jacobians = []
        for m, (transfer, data) in enumerate(zip(self.transfer, self.experiments, strict=True)):
            if isinstance(data, TimeRecord) and free_parameters(self.structure_of_records, self.initial, data):
                jacobian = self._settled(transfer @ theta, data)
            else:
                jacobian = self.local(m, theta)[1]
            jacobians.append(jacobian @ (transfer / self.deviation(m, variances)))
        return np.concatenate([*jacobians, self._prior[0]])

    def _settled(self, zeta: FloatArray, data: TimeRecord) -> FloatArray:
        first = min(SETTLING, len(data) // 2)
        jacobian = prediction_errors(self.structure_of_records, zeta, data)[1][first:]
        if data.level_known:
            return jacobian
        level = level_errors(self.structure_of_records, zeta, len(data))[first:]
        return jacobian - np.outer(level, level @ jacobian / max(float(level @ level), float(np.finfo(float).tiny)))

    def parts(self) -> list[slice]:
        """Where the rows of each experiment stand in the residuals."""
        lengths = [len(e) if isinstance(e, TimeRecord) else 2 * len(e) for e in self.experiments]
        ends = np.cumsum(lengths)
        return [slice(int(end) - length, int(end)) for end, length in zip(ends, lengths, strict=True)]

    def group_variances(self, theta: FloatArray) -> dict[str, float]:
        """The mean square of each group's residuals."""
        white, _ = self.white(theta, dict.fromkeys(self.groups, 1.0))
        return self._pooled(white, np.zeros(len(self.experiments)), dict.fromkeys(self.groups, 1.0))

    def cost_of_scales(self, theta: FloatArray) -> float:
        """Minus twice the log-likelihood when every unknown variance is fitted, up to a constant."""
        white, _ = self.white(theta, dict.fromkeys(self.groups, 1.0))
        variances = self._pooled(white, np.zeros(len(self.experiments)), dict.fromkeys(self.groups, 1.0))
        known = sum(float(white[p] @ white[p]) for p, g in zip(self.parts(), self.group_of, strict=True) if g is None)
        sizes = {g: sum(self.counts[m] for m, other in enumerate(self.group_of) if other == g) for g in self.groups}
        return known + sum(float(sizes[g]) * float(np.log(variances[g])) for g in self.groups)

    def updated_variances(self, solution: LeastSquaresSolution, variances: Mapping[str, float]) -> dict[str, float]:
        """Each group's residual sum of squares over R − tr H, with H the hat matrix of the fit."""
        used = np.array([self.leverage(solution)[part].sum() for part in self.parts()])
        return self._pooled(solution.residual, used, variances)

    @staticmethod
    def leverage(solution: LeastSquaresSolution) -> FloatArray:
        """The diagonal of the hat matrix J (JᵀJ)⁺ Jᵀ, (R,)."""
        scale = np.linalg.norm(solution.jacobian, axis=0)
        u, values, _ = np.linalg.svd(solution.jacobian / np.where(scale > 0, scale, 1.0), full_matrices=False)
        return np.asarray(np.sum(u[:, values > 1e-10 * values[0]] ** 2, axis=1))

    def _pooled(self, white: FloatArray, used: FloatArray, variances: Mapping[str, float]) -> dict[str, float]:
        result = {}
        for group in self.groups:
            members = [m for m, other in enumerate(self.group_of) if other == group]
            parts = self.parts()
            energy = sum(float(white[parts[m]] @ white[parts[m]]) for m in members)
            freedom = max(float(np.sum(self.counts[members] - used[members])), 1.0)
            result[group] = max(variances[group] * energy / freedom, self._rounding(members))
        return result

    def _rounding(self, members: list[int]) -> float:
        data = [self.experiments[m] for m in members]
        signals = [e.output if isinstance(e, TimeRecord) else abs(e.response) for e in data]
        largest = max(float(np.mean(signal**2)) for signal in signals)
        return max(float(np.finfo(float).eps) ** 2 * largest, float(np.finfo(float).tiny))

    def reported_variance(self, variances: Mapping[str, float], theta: FloatArray) -> float:
        """σ̂_e²: the mean over the groups of records; without records the scale of the responses, one where known.

        Of a record in a loop, whose noise model is not among the parameters, the variance of the disturbance.
        """
        records = [variance for group, variance in variances.items() if group.startswith("record")]
        looped = [m for m, data in enumerate(self.experiments) if isinstance(data, RecordInLoop)]
        if looped:
            return float(np.mean([self._disturbance(m, theta) for m in looped]))
        return float(np.mean(records)) if records else float(variances.get("responses", 1.0))
