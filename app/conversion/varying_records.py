"""Records along varying scheduling: documents and kept arrays to records, and what was understood of them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.arrays import finite_or_none
from app.conversion.plants import channels, scheduling_variables
from app.schemas.experiments import (
    Experiment,
    SchedulingRange,
    Understanding,
    Values,
    VaryingRecordData,
    VaryingRecordRequest,
    VaryingUnderstanding,
)
from app.schemas.plants import Plant
from identification.arrays import FloatArray
from identification.errors import ShapeError
from identification.scheduling import SchedulingVariable
from identification.varying.inspection import VaryingInspection, inspect_varying
from identification.varying.records import VaryingRecord

Arrays = dict[str, NDArray[Any]]
SIGNALS = ("input", "output", "scheduling")


def requested_record(plant: Plant, request: VaryingRecordRequest) -> VaryingRecord:
    """The record in the body of a request; raises MisuseError when it is none of the plant."""
    signals = (request.inputs, request.outputs, request.scheduling)
    record = varying_record(
        {name: stacked(lists, name) for name, lists in zip(SIGNALS, signals, strict=True)},
        request.sample_time_seconds,
        request.period_samples,
        scheduling_variables(plant),
    )
    require_varying_channels(record, channels(plant))
    return record


def stacked(lists: Sequence[Values], name: str) -> FloatArray:
    """Lists of samples as (N, channels); raises ShapeError when they differ in length."""
    if len({len(samples) for samples in lists}) > 1:
        raise ShapeError(f"the lists of the {name} differ in length; give as many samples of each channel", name)
    return np.array(lists, dtype=np.float64).T


def varying_record(
    arrays: Mapping[str, NDArray[Any]],
    sample_time: float,
    period: int | None,
    variables: tuple[SchedulingVariable, ...],
) -> VaryingRecord:
    """The record of kept arrays."""
    u, y, p = (arrays[name] for name in SIGNALS)
    return VaryingRecord(u, y, p, sample_time, period, variables)


def require_varying_channels(record: VaryingRecord, expected: tuple[int, int]) -> None:
    """Raises ShapeError unless a record has this number of outputs and of inputs."""
    for name, count in zip(("output", "input"), expected, strict=True):
        found = getattr(record, name).shape[1]
        if found != count:
            raise ShapeError(f"the record has {found} {name}s, the plant has {count}", name)


def kept_record(experiment: Experiment, plant: Plant, arrays: Mapping[str, NDArray[Any]]) -> VaryingRecord:
    """The record of an experiment that was kept."""
    assert experiment.sample_time_seconds is not None, "records have a sample time"
    period = experiment.understood.period_samples
    return varying_record(arrays, experiment.sample_time_seconds, period, scheduling_variables(plant))


def record_arrays(record: VaryingRecord) -> Arrays:
    """The arrays that are kept of a record."""
    return {name: getattr(record, name) for name in SIGNALS}


def record_data(experiment: Experiment, arrays: Mapping[str, NDArray[Any]]) -> VaryingRecordData:
    """The samples as lists."""
    assert experiment.sample_time_seconds is not None, "records have a sample time"
    u, y, p = (arrays[name].T.tolist() for name in SIGNALS)
    return VaryingRecordData(
        kind="varyingRecord", sample_time_seconds=experiment.sample_time_seconds, inputs=u, outputs=y, scheduling=p
    )


def record_columns(experiment: Experiment, arrays: Mapping[str, NDArray[Any]]) -> Arrays:
    """Time and one column a channel, as files hold them."""
    assert experiment.sample_time_seconds is not None, "records have a sample time"
    columns: Arrays = {"time": np.arange(len(arrays["input"])) * experiment.sample_time_seconds}
    for letter, name in zip("uyp", SIGNALS, strict=True):
        columns |= {f"{letter}{i + 1}": column for i, column in enumerate(arrays[name].T)}
    return columns


def varying_understanding(record: VaryingRecord) -> Understanding:
    """The document of what a record shows; raises RangeError for signals of zeros."""
    seen = inspect_varying(record)
    lines, steady = seen.excited_frequencies, seen.steady
    return Understanding(
        samples=seen.samples,
        duration_seconds=seen.duration,
        period_samples=seen.period,
        period_detected=seen.period_detected,
        periods=None if seen.period is None else seen.samples // seen.period,
        transient_periods=None if steady is None else steady.dropped,
        input_count=record.input.shape[1],
        output_count=record.output.shape[1],
        frequency_count=len(lines),
        minimum_frequency_rad_per_second=float(lines.min()) if len(lines) else None,
        maximum_frequency_rad_per_second=float(lines.max()) if len(lines) else None,
        excited_frequencies_rad_per_second=lines.tolist(),
        signal_to_noise_decibel=finite_or_none(seen.signal_to_noise_db),
        saturated_fraction=seen.saturated_fraction,
        varying=_varying(record, seen),
        warnings=list(seen.warnings),
    )


def _varying(record: VaryingRecord, seen: VaryingInspection) -> VaryingUnderstanding:
    steady = seen.steady
    ends = zip(record.variables, seen.minimum, seen.maximum, strict=True)
    return VaryingUnderstanding(
        ranges=[
            SchedulingRange(name=one.name, unit=one.unit, minimum=float(low), maximum=float(high))
            for one, low, high in ends
        ],
        synchronised=steady is not None,
        reason=seen.not_synchronised,
        input_period_samples=seen.own_periods[0],
        scheduling_period_samples=seen.own_periods[1],
        input_deviation=finite_or_none(seen.input_deviation),
        scheduling_deviation=finite_or_none(seen.scheduling_deviation),
        steady_periods=None if steady is None else len(steady.output),
        transient_rule=None if steady is None else steady.rule,
        left_over_samples=None if steady is None else steady.left_over,
        noise_levels=None if seen.noise_deviations is None else seen.noise_deviations.tolist(),
    )
