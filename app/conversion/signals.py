"""How long the signals of a design are."""

from app.schemas.designs import Design, DesignedExperimentDocument
from app.schemas.signals import SignalsRequest


def lengths(design: Design, experiment: DesignedExperimentDocument, request: SignalsRequest) -> tuple[int, int]:
    """Samples of a period, and periods: as asked for, else such that the duration is that of the design."""
    if experiment.spectrum.kind == "multisine":
        return request.samples or experiment.spectrum.period_samples, request.periods or experiment.spectrum.periods
    if experiment.spectrum.kind == "lines":
        period = request.samples or experiment.spectrum.period_samples
        return period, request.periods or -(-design.samples // period)
    periods = request.periods or 1
    return request.samples or max(2, -(-design.samples // periods)), periods
