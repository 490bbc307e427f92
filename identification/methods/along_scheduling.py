"""State-space models from one record along p(t)."""

from dataclasses import dataclass, replace
from typing import ClassVar, cast

from identification.bases.polynomial import Polynomial
from identification.estimates import Estimate
from identification.methods.method import Method, Takes, Task
from identification.models.state_space import StateSpaceStructure
from identification.scheduling import ProductBasis
from identification.varying.affine_estimate import AffineEstimate
from identification.varying.correlation_realisation import CorrelationRealisation
from identification.varying.frozen import affine_model
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.progress import Progress
from identification.varying.records import VaryingRecord


@dataclass(frozen=True)
class AlongScheduling(Method):
    """Matrices affine in p from a record along p(t), by maximum likelihood.

    In the frequency domain where the record states the period of input and scheduling together [Goos2014], else from
    correlations or least squares, refined in the time domain [Cox2018].
    """

    kind: ClassVar[str] = "along_scheduling"
    takes: ClassVar[Takes] = Takes((VaryingRecord,), (StateSpaceStructure,))

    def refuses(self, task: Task) -> str | None:
        """One record in discrete time; bases 1, p_1, p_2, …"""
        affine = ProductBasis((Polynomial(1),) * len(task.dependence.variables), total_degree=1)
        if len(task.data) != 1:
            return f"{len(task.data)} records are given; give one"
        if set(task.dependence.bases) != {affine}:
            return f"its matrices are affine in p; give {affine} for all of them"
        if task.structure.sample_time != _record(task).sample_time:
            return "the structure is of another sample time; give that of the record"
        return None

    def estimate(self, task: Task, progress: Progress) -> Estimate:
        """The model, its scheduling variables with the declared ranges."""
        record = replace(_record(task), variables=task.dependence.variables)
        found: AffineEstimate
        if record.period is not None:
            found = PeriodicLikelihood().estimate(record, task.structure.order, progress=progress)
        else:
            found = CorrelationRealisation(refinement=True).estimate(record, task.structure.order, progress=progress)
        return Estimate(affine_model(found), found.outcome, found.tests)


def _record(task: Task) -> VaryingRecord:
    return cast(VaryingRecord, task.data[0])
