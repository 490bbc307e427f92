"""State-space models from one record along p(t)."""

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self, cast

from identification.estimates import Estimate
from identification.methods.method import Method, Takes, Task
from identification.models.state_space import StateSpaceStructure
from identification.varying.correlation_realisation import CorrelationRealisation
from identification.varying.output_error import OutputError
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.progress import Progress, within
from identification.varying.records import VaryingRecord


@dataclass(frozen=True)
class AlongScheduling(Method):
    """Matrices over any functions of p from a record along p(t), by maximum likelihood.

    `first` is the estimator that begins, one of `identification.varying` that needs no start, and `refinement` one
    that takes its model as start, or none. Usually in the frequency domain where the record states the period of input
    and scheduling together [Goos2014], else from correlations or least squares, refined in the time domain [Cox2018].
    """

    kind: ClassVar[str] = "along_scheduling"
    takes: ClassVar[Takes] = Takes((VaryingRecord,), (StateSpaceStructure,), start=True)

    first: Any = field(default_factory=CorrelationRealisation)
    refinement: Any = None

    def refuses(self, task: Task) -> str | None:
        """One record in discrete time; one basis for all matrices."""
        if len(task.data) != 1:
            return f"{len(task.data)} records are given; give one"
        if len(set(task.dependence.bases)) != 1:
            return "its matrices are all over the same functions; give one basis for A, B, C and D"
        if task.structure.sample_time != _record(task).sample_time:
            return "the structure is of another sample time; give that of the record"
        return None

    def estimate(self, task: Task, progress: Progress) -> Estimate:
        """The model, its scheduling variables with the declared ranges; a start is refined."""
        record = replace(_record(task), variables=task.dependence.variables)
        basis, order, start = task.dependence.bases[0], task.structure.order, task.start
        if start is None:
            found: Estimate = self.first.estimate(record, order, basis=basis, progress=within(progress, 0.0, 0.5))
            if self.refinement is None:
                return found
            start = found.model
        refinement = self.refinement or (OutputError() if record.period is None else PeriodicLikelihood())
        refined: Estimate = refinement.estimate(record, order, start, basis=basis, progress=within(progress, 0.5, 1.0))
        return refined

    @classmethod
    def usual(cls, task: Task) -> Self:
        """By whole periods where the record has them."""
        return cls() if _record(task).period is None else cls(first=PeriodicLikelihood())


def _record(task: Task) -> VaryingRecord:
    return cast(VaryingRecord, task.data[0])
