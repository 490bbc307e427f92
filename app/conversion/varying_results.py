"""What an identification from varying scheduling found beside the model itself, as documents."""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from app.schemas.varying import NoiseSpectrumDocument, SteadyPeriodsDocument, VaryingFit
from identification.along import simulate_along
from identification.errors import MisuseError
from identification.models.model import Model
from identification.varying.noise_spectrum import NoiseSpectrum, noise_between_harmonics, noise_of_errors
from identification.varying.records import TOLERANCE, SteadyPeriods, VaryingRecord, steady_periods
from identification.varying.reproduction import reproduced


def used_periods(record: VaryingRecord, estimators: Sequence[Any]) -> SteadyPeriods | None:
    """The steady periods as the last of the estimators that has such options takes them; None where there are none."""
    asked = [one for one in estimators if hasattr(one, "drop_periods")]
    options = (asked[-1].drop_periods, asked[-1].tolerance) if asked else (None, TOLERANCE)
    try:
        return steady_periods(record, *options)
    except MisuseError:
        return None


def steady_document(steady: SteadyPeriods) -> SteadyPeriodsDocument:
    """What of a synchronised record was used, and by which rule."""
    return SteadyPeriodsDocument(
        period_samples=steady.periodicity.period,
        scheduling_period_samples=steady.periodicity.scheduling_period,
        steady_periods=len(steady.output),
        dropped_periods=steady.dropped,
        left_over_samples=steady.left_over,
        transient_rule=steady.rule,
        deviation=steady.periodicity.deviation,
    )


def fit_document(
    model: Model, record: VaryingRecord, experiment_id: str, data: Literal["fitted", "heldOut"]
) -> VaryingFit:
    """How well the model reproduces a record, or why it cannot be told."""
    try:
        found = reproduced(model, record)
        known = model.covariance is not None
        deviations = simulate_along(model, record.input, record.scheduling, known).deviation
    except MisuseError as error:
        return VaryingFit(
            experiment_id=experiment_id,
            data=data,
            bfr_percent=None,
            vaf_percent=None,
            reason=str(error),
            output_deviations=None,
        )
    return VaryingFit(
        experiment_id=experiment_id,
        data=data,
        bfr_percent=found.best_fit_rate,
        vaf_percent=found.variance_accounted_for,
        output_deviations=None if deviations is None else np.sqrt(np.mean(deviations**2, axis=0)).tolist(),
    )


def noise_document(model: Model, record: VaryingRecord, steady: SteadyPeriods | None) -> NoiseSpectrumDocument | None:
    """From the lines between the harmonics where there are enough, else from the residuals of the model."""
    source: Literal["betweenHarmonics", "residuals"] = "betweenHarmonics"
    try:
        if steady is None:
            source = "residuals"
            errors = record.output - reproduced(model, record).output
            found = noise_of_errors(errors, record.sample_time)
        else:
            found = noise_between_harmonics(steady, record.sample_time)
    except MisuseError:
        return None
    return _document(source, found)


def _document(source: Literal["betweenHarmonics", "residuals"], found: NoiseSpectrum) -> NoiseSpectrumDocument:
    return NoiseSpectrumDocument(
        source=source,
        frequencies_rad_per_second=found.frequencies.tolist(),
        spectra=found.spectrum.T.tolist(),
        covariance=found.covariance.tolist(),
        degrees_of_freedom=found.degrees_of_freedom,
    )
