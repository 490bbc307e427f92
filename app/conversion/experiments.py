"""Experiments: documents and kept arrays to measurements."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.schemas.experiments import Experiment, TimeRecordRequest
from app.schemas.experiments import FrequencyResponseRequest as ResponseRequest
from app.store.arrays import ArrayStore
from identification.signals import FrequencyResponse, Measurement, TimeRecord


def requested_measurement(request: TimeRecordRequest | ResponseRequest) -> Measurement:
    """The measurement in the body of a request; raises MisuseError when it is none."""
    point = tuple(request.operating_point)
    if isinstance(request, TimeRecordRequest):
        return TimeRecord(
            np.array(request.input),
            np.array(request.output),
            request.sample_time_seconds,
            point,
            request.period_samples,
        )
    return FrequencyResponse(
        np.array(request.frequencies_rad_per_second),
        request.response.array(),
        point,
        request.sample_time_seconds,
        None if request.variance is None else np.array(request.variance),
        request.variance_degrees_of_freedom,
    )


def kept_measurement(experiment: Experiment, arrays: Mapping[str, NDArray[Any]]) -> Measurement:
    """The measurement of an experiment that was kept."""
    point = tuple(experiment.operating_point)
    if experiment.kind == "timeRecord":
        assert experiment.sample_time_seconds is not None, "time records have a sample time"
        period = experiment.understood.period_samples
        return TimeRecord(arrays["input"], arrays["output"], experiment.sample_time_seconds, point, period)
    return FrequencyResponse(
        arrays["frequenciesRadPerSecond"],
        arrays["response"],
        point,
        experiment.sample_time_seconds,
        arrays.get("variance"),
        experiment.variance_degrees_of_freedom,
    )


def kept_measurements(given: Sequence[Mapping[str, Any]], arrays: ArrayStore) -> list[Measurement]:
    """The measurements of the experiments in a payload, {"document": …, "arrays": hash} each."""
    return [kept_measurement(Experiment.model_validate(one["document"]), arrays.get(one["arrays"])) for one in given]
