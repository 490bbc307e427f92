"""Frequency responses of models that were kept."""

from typing import Any

import numpy as np

from app.arrays import ComplexVector
from app.conversion.misuse import pointing
from app.conversion.models import kept_model
from app.errors import UnprocessableError
from app.schemas.models import ModelFrequencyResponse
from app.services.models import get, require_without_effects
from app.services.plants import get as get_plant
from app.store.resources import ResourceRepository
from identification.arrays import FloatArray
from identification.confidence import GainAndPhase, gain_and_phase
from identification.errors import RangeError

BANDS = ("magnitude_lower95", "magnitude_upper95", "phase_lower95_rad", "phase_upper95_rad")


def frequency_response(
    resources: ResourceRepository, model_id: str, point: list[float], minimum: float, maximum: float, count: int
) -> ModelFrequencyResponse:
    """The response of a model at one operating point over a band, with 95 % bands."""
    document = get(resources, model_id)
    require_without_effects(document, "/modelId", "path")
    model = kept_model(document, get_plant(resources, document.plant_id))
    if minimum > maximum:
        raise UnprocessableError.at("/maximumRadPerSecond", "the band must rise", "query")
    step = model.structure.sample_time
    if step is not None and maximum > np.pi / step * (1 + 1e-9):
        raise UnprocessableError.at(
            "/maximumRadPerSecond", f"lies above the Nyquist frequency {np.pi / step:.6g} rad/s", "query"
        )
    omega = np.geomspace(minimum, maximum, count) if minimum > 0 else np.linspace(minimum, maximum, count)
    known = document.covariance is not None
    with pointing({}, "/operatingPoint", "query"):
        response = model.frequency_response([point], omega)[0]
        covariance = model.response_covariance([point], omega)[0] if known else np.zeros((count, 2, 2))
        if not (np.isfinite(response).all() and np.isfinite(covariance).all()):
            raise RangeError("the response is infinite in this band, e.g. at a pole; leave that frequency out")
    return ModelFrequencyResponse(
        model_id=model_id,
        operating_point=point,
        frequencies_rad_per_second=omega.tolist(),
        response=ComplexVector.of(response),
        **_gain_and_phase(gain_and_phase(response, covariance), known),
        **_covariance(covariance, known),
    )


def _gain_and_phase(values: GainAndPhase, known: bool) -> dict[str, Any]:
    gain, phase = values.gain_band(), values.phase_band()
    bands = dict(zip(BANDS, (*gain, *phase), strict=True))
    return {
        "magnitude": values.gain.tolist(),
        "phase_rad": values.phase.tolist(),
        **{name: band.tolist() if known else None for name, band in bands.items()},
    }


def _covariance(covariance: FloatArray, known: bool) -> dict[str, Any]:
    parts = {
        "real_variance": covariance[:, 0, 0],
        "imaginary_variance": covariance[:, 1, 1],
        "real_imaginary_covariance": covariance[:, 0, 1],
    }
    return {name: part.tolist() if known else None for name, part in parts.items()}
