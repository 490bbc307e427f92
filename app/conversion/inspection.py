"""What was understood of a measurement, as a document."""

from app.arrays import finite_or_none
from app.schemas.experiments import Understanding
from identification.measurements.inspection import RecordInspection, ResponseInspection, inspect
from identification.signals import FrequencyResponse, Measurement


def understanding(data: Measurement) -> Understanding:
    """The document of what a measurement shows; raises RangeError for records or responses of zeros."""
    seen = inspect(data)
    if isinstance(seen, RecordInspection):
        return _of_record(seen)
    assert isinstance(data, FrequencyResponse), "what is no record is a response"
    return _of_response(seen, data)


def _of_record(seen: RecordInspection) -> Understanding:
    lines = seen.excited_frequencies
    return Understanding(
        samples=seen.samples,
        duration_seconds=seen.duration,
        period_samples=seen.period,
        period_detected=seen.period_detected,
        periods=seen.periods if seen.period is not None else None,
        transient_periods=seen.transient_periods,
        frequency_count=len(lines),
        minimum_frequency_rad_per_second=float(lines.min()) if len(lines) else None,
        maximum_frequency_rad_per_second=float(lines.max()) if len(lines) else None,
        excited_frequencies_rad_per_second=lines.tolist(),
        noise_level=finite_or_none(seen.noise_deviation),
        signal_to_noise_decibel=finite_or_none(seen.signal_to_noise_db),
        saturated_fraction=finite_or_none(seen.saturated_fraction),
        input_offset=finite_or_none(seen.input_offset),
        output_offset=finite_or_none(seen.output_offset),
        output_trend=finite_or_none(seen.output_trend),
        outliers=seen.outliers,
        warnings=list(seen.warnings),
    )


def _of_response(seen: ResponseInspection, data: FrequencyResponse) -> Understanding:
    return Understanding(
        input_count=data.input_count,
        output_count=data.output_count,
        frequency_count=seen.count,
        minimum_frequency_rad_per_second=seen.lowest_frequency,
        maximum_frequency_rad_per_second=seen.highest_frequency,
        frequency_spacing=seen.spacing,
        relative_deviation=finite_or_none(seen.relative_deviation),
        warnings=list(seen.warnings),
    )
