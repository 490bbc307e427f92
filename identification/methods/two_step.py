"""Rational models from local experiments: a model at each operating point, then one over all of them."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol, Self, cast

import numpy as np

from identification.errors import MisuseError
from identification.estimates import Estimate, LocalEstimate
from identification.lpv.joint_likelihood import JointLikelihood
from identification.lti.prediction_error import PredictionError
from identification.lti.rational_fit import RationalFit
from identification.measurements.inspection import inspect_record
from identification.methods.in_loop import require_judgeable, with_feedback
from identification.methods.method import Data, Method, Takes, Task, held_still
from identification.models.physical import PhysicalForm, RationalForm
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse, Measurement, TimeRecord
from identification.spectral.local_polynomial import LocalPolynomial
from identification.spectral.periodic_average import PeriodicAverage
from identification.varying.progress import Progress


class Spectral(Protocol):
    """A way from a record to a frequency response: what the plug-ins of `identification.spectral` are."""

    def estimate(self, record: TimeRecord) -> FrequencyResponse:
        """The response."""


@dataclass(frozen=True)
class TwoStep(Method):
    """Local models, then the parameter-varying one [Ghosh2018, Theorem 1], or all data at once from that start.

    `spectral` makes frequency responses of records where `local` takes those; `local` is one of `identification.lti`,
    `joint` one of `identification.lpv`. Without `local` each record is fitted by its prediction errors and each
    response by a rational fit.
    """

    kind: ClassVar[str] = "two_step"
    takes: ClassVar[Takes] = Takes((TimeRecord, FrequencyResponse), (RationalStructure, PhysicalForm), prior=True)

    spectral: Spectral | None = None
    local: Any = None
    joint: Any = field(default_factory=JointLikelihood)

    def estimate(self, task: Task, progress: Progress) -> Estimate:
        """The model with its local ones; misuse of one experiment is named by its place and operating point."""
        structure = cast(RationalForm, task.structure)
        given, seen = with_feedback(structure.plain, held_still(task))
        data = [self._fitted(structure, one, i, progress) for i, one in enumerate(given)]
        local = self._local_estimates(structure, data, progress)
        progress(0.8, "the parameter-varying model")
        found: Estimate = self.joint.estimate(structure, task.dependence, data, local, prior=task.prior)
        noted = replace(found, fitted=tuple(data), tests=(*found.tests, *seen.tests), outcome=seen.noted(found.outcome))
        return _with_output_noise(noted, task.data)

    def _fitted(self, structure: RationalForm, record: Measurement, index: int, progress: Progress) -> Measurement:
        """The data themselves, or the response of a record where the local method takes those."""
        if not isinstance(record, TimeRecord) or self.spectral is None or self._takes_records:
            return record
        progress(0.05, f"the frequency response of experiment {index + 1}")
        with _place_named(index, record):
            require_judgeable(record)
            response = self.spectral.estimate(record)
        return response if structure.is_discrete else replace(response, sample_time=None, held=record.held)

    @property
    def _takes_records(self) -> bool:
        return self.local is not None and self.local.data is TimeRecord

    def _local_estimates(
        self, structure: RationalForm, data: Sequence[Measurement], progress: Progress
    ) -> list[LocalEstimate]:
        estimates = []
        for i, measurement in enumerate(data):
            progress(0.1 + 0.7 * i / len(data), f"local model {i + 1} of {len(data)}")
            with _place_named(i, measurement):
                estimates.append(self._local(measurement).estimate(structure, measurement))
        return estimates

    def _local(self, measurement: Measurement) -> Any:
        usual = PredictionError if isinstance(measurement, TimeRecord) else RationalFit
        return self.local or usual()

    @classmethod
    def usual(cls, task: Task) -> Self:
        """Records by their prediction errors where they can be, else by their frequency responses."""
        structure = cast(RationalForm, task.structure)
        if structure.is_discrete and not structure.delay:
            return cls()
        periodic = all(isinstance(one, FrequencyResponse) or one.period_count >= 2 for one in held_still(task))
        return cls(spectral=PeriodicAverage() if periodic else LocalPolynomial(), local=RationalFit())


def _with_output_noise(estimate: Estimate, given: Sequence[Data]) -> Estimate:
    """The noise variance of the output in its unit, as designs need it, where responses of records were fitted.

    Fits of responses give it as a factor on the variances of the responses only.
    """
    records = [one for one in given if isinstance(one, TimeRecord)]
    if len(records) < len(given) or any(isinstance(one, TimeRecord) for one in estimate.fitted):
        return estimate
    levels = np.array([inspect_record(record).noise_deviation for record in records], dtype=np.float64)
    if not np.all(np.isfinite(levels) & (levels > 0)):
        return estimate
    return replace(estimate, model=replace(estimate.model, noise_variance=float(np.mean(levels**2))))


@contextmanager
def _place_named(index: int, measurement: Measurement) -> Iterator[None]:
    try:
        yield
    except MisuseError as error:
        where = ", ".join(f"{value:g}" for value in measurement.operating_point)
        raise MisuseError(f"the experiment at {where}: {error}", f"data[{index}]") from error
