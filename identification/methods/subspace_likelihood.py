"""State-space models of any number of channels from frequency responses at operating points held still."""

from dataclasses import dataclass, field, replace
from typing import ClassVar

from identification.estimates import Estimate
from identification.methods.method import Method, Takes, Task, held_still
from identification.models.state_space import StateSpaceStructure
from identification.parametric.parametric_subspace import ParametricSubspace
from identification.parametric.state_space_likelihood import StateSpaceLikelihood
from identification.signals import FrequencyResponse, TimeRecord
from identification.spectral.local_polynomial import LocalPolynomial
from identification.spectral.periodic_average import PeriodicAverage
from identification.varying.progress import Progress


@dataclass(frozen=True)
class SubspaceLikelihood(Method):
    """A parametric subspace estimate [Kergus2019], refined by maximum likelihood [PintelonSchoukens2012, Chapter 9].

    Records of one channel become frequency responses first. Poles may be kept in the region of `refinement`.
    """

    kind: ClassVar[str] = "subspace_likelihood"
    takes: ClassVar[Takes] = Takes((TimeRecord, FrequencyResponse), (StateSpaceStructure,), start=True, prior=True)

    refinement: StateSpaceLikelihood = field(default_factory=StateSpaceLikelihood)

    def estimate(self, task: Task, progress: Progress) -> Estimate:
        """The model with the covariance of its entries, whose rank is that of what any response shows."""
        order, discrete = task.structure.order, task.structure.is_discrete
        data = [self._response(one, discrete) for one in held_still(task)]
        start = task.start or task.prior
        if start is None:
            progress(0.1, "the subspace estimate")
            first = ParametricSubspace(order=order, region=self.refinement.region)
            start = first.estimate(task.dependence, data).model
        progress(0.4, "maximum likelihood")
        return self.refinement.estimate(start, data, task.prior)

    def refuses(self, task: Task) -> str | None:
        """Responses must have the channels of the structure; a start must be of it."""
        for name, given in (("start", task.start), ("prior", task.prior)):
            if given is not None and (given.structure, given.dependence) != (task.structure, task.dependence):
                return f"the {name} has another structure or dependence; give one of those asked for"
        asked = (task.structure.outputs, task.structure.inputs)
        for one in held_still(task):
            channels = one.matrices.shape[1:] if isinstance(one, FrequencyResponse) else (1, 1)
            if channels != asked:
                return f"the data have {channels} outputs × inputs and the structure {asked}; give the same in both"
        return None

    def _response(self, one: TimeRecord | FrequencyResponse, discrete: bool) -> FrequencyResponse:
        if isinstance(one, FrequencyResponse):
            return one
        spectral = PeriodicAverage() if one.period_count >= 2 else LocalPolynomial()
        response = spectral.estimate(one)
        return response if discrete else replace(response, sample_time=None)
