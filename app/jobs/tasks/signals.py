"""Makes the signals of a design."""

from typing import Any

import numpy as np

from app import __version__
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.signals import lengths
from app.conversion.spectra import spectrum_object
from app.jobs.task import TaskContext, TaskResult
from app.schemas.designs import Design, DesignedExperimentDocument
from app.schemas.signals import SignalDocument, SignalsRequest
from app.services.signals import MOST_SAMPLES
from identification.errors import RangeError
from oed.realisation.realise import realise
from oed.realisation.realised_signal import RealisedSignal

KIND = "signals"
FIELDS = {"amplitude_limit": "/amplitudeLimit", "samples": "/samples", "periods": "/periods", "method": "/method"}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """One signal an operating point, each from its own random generator."""
    design = Design.model_validate(payload["design"])
    request = SignalsRequest.model_validate(payload["request"])
    generators = np.random.default_rng(request.seed).spawn(len(design.experiments))
    documents, arrays = [], {}
    for i, (experiment, generator) in enumerate(zip(design.experiments, generators, strict=True)):
        context.progress(i / len(design.experiments), f"signal {i + 1} of {len(design.experiments)}")
        with field_named(FIELDS), within_doubles():
            signal = _realised(design, experiment, request, generator)
        arrays[f"period{i}"] = signal.signal
        documents.append(_document(i, experiment, signal).as_json())
    document = {
        "softwareVersion": __version__,
        "modelId": design.model_id,
        "designId": design.id,
        "request": payload["request"],
        "seed": request.seed,
        "signals": documents,
    }
    return TaskResult(document, context.arrays.put(arrays))


def _realised(
    design: Design, experiment: DesignedExperimentDocument, request: SignalsRequest, generator: np.random.Generator
) -> RealisedSignal:
    period, periods = lengths(design, experiment, request)
    signal = realise(
        spectrum_object(experiment.spectrum, design.sample_time_seconds),
        period,
        design.sample_time_seconds,
        generator=generator,
        method=request.method,
        periods=periods,
        amplitude_limit=request.amplitude_limit,
        oversampling=request.oversampling,
    )
    if signal.samples > MOST_SAMPLES:
        raise RangeError(
            f"the signal would need {signal.samples} samples, at most {MOST_SAMPLES} are made; raise the limit",
            "amplitude_limit",
        )
    return signal


def _document(index: int, experiment: DesignedExperimentDocument, signal: RealisedSignal) -> SignalDocument:
    asked = np.flatnonzero(signal.requested_energies > 0)
    elsewhere = np.delete(signal.achieved_energies, asked)
    return SignalDocument(
        index=index,
        operating_point=experiment.operating_point,
        sample_time_seconds=signal.sample_time,
        period_samples=signal.period,
        periods=signal.periods,
        samples=signal.samples,
        duration_seconds=signal.duration,
        energy=signal.energy,
        peak=signal.peak,
        crest_factor=signal.crest_factor,
        crest_factor_between_samples=signal.crest_factor_between_samples,
        amplitude_limit=signal.amplitude_limit,
        amplitude_limit_binds=signal.amplitude_limit_binds,
        needed_samples=signal.needed_samples,
        frequencies_rad_per_second=(2 * np.pi * asked / (signal.period * signal.sample_time)).tolist(),
        requested_energies=signal.requested_energies[asked].tolist(),
        achieved_energies=signal.achieved_energies[asked].tolist(),
        energy_elsewhere=float(elsewhere.sum()),
    )
