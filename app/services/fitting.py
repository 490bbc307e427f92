"""Whether experiments, model structure and estimators fit each other, before a job is started for them."""

from collections.abc import Sequence

from app.conversion.misuse import pointing
from app.conversion.models import kept_model
from app.errors import UnprocessableError
from app.schemas.experiments import Experiment
from app.schemas.models import Model, ModelRequest
from app.schemas.plants import Plant
from identification.models.physical import RationalForm
from identification.scheduling import ParameterDependence
from identification.signals import TimeRecord

SAMPLE_TIME_TOLERANCE = 1e-6


def check_fitting(request: ModelRequest, structure: RationalForm, experiments: Sequence[Experiment]) -> None:
    """Raises UnprocessableError at the field that does not fit."""
    takes_records = request.local_estimator.build().data is TimeRecord
    kind = request.local_estimator.kind  # type: ignore[attr-defined]
    if takes_records and (not structure.is_discrete or structure.delay):
        raise UnprocessableError.at(
            "/localEstimator",
            f"{kind} fits models in discrete time without an estimated delay; use one that takes frequency responses",
        )
    if not takes_records and structure.n_noise:
        raise UnprocessableError.at(
            "/structure", f"{kind} takes frequency responses, which say nothing about the noise; set nc = nd = 0"
        )
    for i, experiment in enumerate(experiments):
        pointer = f"/experimentIds/{i}"
        if experiment.kind != "timeRecord":
            _check_response(takes_records, kind, structure, experiment, pointer)
        else:
            _check_record(takes_records, request, structure, experiment, pointer)


def check_prior(
    plant: Plant,
    prior: Model,
    structure: RationalForm,
    dependence: ParameterDependence,
    experiment_ids: Sequence[str],
) -> None:
    """Raises UnprocessableError unless the information of a prior model can be added to that of the experiments."""
    with pointing({}, default="/priorModelId"):
        earlier = kept_model(prior, plant)
    if earlier.structure != structure or earlier.dependence != dependence:
        reason = "has another structure or basis than the model asked for"
    elif prior.covariance is None:
        reason = "has no covariance, so what it tells cannot be weighed"
    elif set(prior.experiment_ids) & set(experiment_ids):
        reason = "was identified from some of the same experiments, which would count twice"
    else:
        return
    raise UnprocessableError.at("/priorModelId", f"the prior model {reason}")


def _check_response(
    takes_records: bool, kind: str, structure: RationalForm, experiment: Experiment, pointer: str
) -> None:
    if takes_records:
        raise UnprocessableError.at(pointer, f"this is a frequency response; {kind} takes time records")
    if experiment.kind == "matrixFrequencyResponse":
        raise UnprocessableError.at(pointer, f"this response has several inputs or outputs; {kind} takes one of each")
    check_sample_time(experiment, structure.sample_time, pointer)


def _check_record(
    takes_records: bool, request: ModelRequest, structure: RationalForm, experiment: Experiment, pointer: str
) -> None:
    if not takes_records and request.spectral_estimator is None:
        raise UnprocessableError.at(
            "/spectralEstimator", "choose how the time records become the frequency responses that are fitted"
        )
    if structure.is_discrete:
        check_sample_time(experiment, structure.sample_time, pointer)


def check_sample_time(experiment: Experiment, sample_time: float | None, pointer: str) -> None:
    """Raises UnprocessableError unless an experiment is in the time domain, and of the sample time, of a model."""
    if not _same(experiment.sample_time_seconds, sample_time):
        raise UnprocessableError.at(pointer, _sample_times(experiment.sample_time_seconds, sample_time))


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return abs(one / other - 1) <= SAMPLE_TIME_TOLERANCE


def _sample_times(data: float | None, model: float | None) -> str:
    return f"the data is {_domain(data)}, the model structure {_domain(model)}; choose others"


def _domain(sample_time: float | None) -> str:
    return "in continuous time" if sample_time is None else f"sampled every {sample_time:g} s"
