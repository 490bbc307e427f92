"""The arrays of experiments, on their way out."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.arrays import ComplexMatrices, ComplexVector
from app.container import Container
from app.conversion.experiments import kept_measurement
from app.conversion.extremes import finite
from app.conversion.varying_records import record_columns, record_data
from app.errors import UnprocessableError
from app.files.stored import Format, arrays_file
from app.schemas.experiments import (
    Experiment,
    ExperimentData,
    FrequencyResponseData,
    MatrixFrequencyResponseData,
    RecordSpectrumDocument,
    TimeRecordData,
)
from app.services.experiments import KIND, experiment_of
from identification.measurements.record_spectrum import record_spectrum
from identification.signals import TimeRecord


def _kept(container: Container, experiment_id: str) -> tuple[Experiment, dict[str, NDArray[Any]]]:
    resource = container.resources.get(KIND, experiment_id)
    assert resource.arrays is not None, "experiments have arrays"
    return experiment_of(resource), container.arrays.get(resource.arrays)


def as_document(container: Container, experiment_id: str) -> ExperimentData:
    """The arrays as lists."""
    experiment, kept = _kept(container, experiment_id)
    if experiment.kind == "varyingRecord":
        return ExperimentData(record_data(experiment, kept))
    data = kept_measurement(experiment, kept)
    if isinstance(data, TimeRecord):
        return ExperimentData(
            TimeRecordData(
                kind="timeRecord",
                sample_time_seconds=data.sample_time,
                input=data.input.tolist(),
                output=data.output.tolist(),
            )
        )
    variance = None if data.variance is None else data.variance.tolist()
    if data.response.ndim > 1:
        return ExperimentData(
            MatrixFrequencyResponseData(
                kind="matrixFrequencyResponse",
                frequencies_rad_per_second=data.frequencies.tolist(),
                response=ComplexMatrices.of(data.response),
                variance=variance,
            )
        )
    return ExperimentData(
        FrequencyResponseData(
            kind="frequencyResponse",
            frequencies_rad_per_second=data.frequencies.tolist(),
            response=ComplexVector.of(data.response),
            variance=variance,
        )
    )


def spectrum(container: Container, experiment_id: str) -> RecordSpectrumDocument:
    """The amplitudes of a time record; raises UnprocessableError for other experiments."""
    experiment, kept = _kept(container, experiment_id)
    if experiment.kind != "timeRecord":
        raise UnprocessableError.at("/experimentId", "only time records at one operating point have a spectrum", "path")
    data = kept_measurement(experiment, kept)
    assert isinstance(data, TimeRecord), "it is of this kind"
    found = record_spectrum(data)
    return RecordSpectrumDocument(
        experiment_id=experiment_id,
        periods=found.periods,
        frequencies_rad_per_second=found.frequencies.tolist(),
        input=finite(found.input, "amplitudes").tolist(),
        output=finite(found.output, "amplitudes").tolist(),
        noise=None if found.noise is None else finite(found.noise, "amplitudes").tolist(),
        excited=found.excited.tolist(),
    )


def as_file(container: Container, experiment_id: str, file_format: Format) -> bytes:
    """The arrays as a file that can be brought in again."""
    experiment, kept = _kept(container, experiment_id)
    if experiment.kind == "varyingRecord":
        return arrays_file(record_columns(experiment, kept), file_format)
    data = kept_measurement(experiment, kept)
    arrays: dict[str, NDArray[Any]]
    if isinstance(data, TimeRecord):
        time = np.arange(len(data)) * data.sample_time
        arrays = {"time": time, "input": data.input, "output": data.output}
    else:
        arrays = {"frequenciesRadPerSecond": data.frequencies, "response": data.response}
        if data.variance is not None:
            arrays["variance"] = data.variance
        if data.sample_time is not None:
            arrays["sampleTimeSeconds"] = np.array(data.sample_time)
    return arrays_file(arrays, file_format)
