"""Frequency responses of models that were kept."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.arrays import ComplexVector
from app.conversion.effects import extended_model
from app.conversion.misuse import pointing
from app.conversion.models import kept_model
from app.conversion.state_space import kept_local, kept_state_space
from app.errors import UnprocessableError
from app.schemas.models import Model, ModelFrequencyResponse
from app.schemas.plants import Plant
from app.services.models import get
from app.services.plants import get as get_plant
from app.store.resources import ResourceRepository
from identification.arrays import ComplexArray, FloatArray
from identification.confidence import GainAndPhase, gain_and_phase
from identification.errors import RangeError
from identification.extension.response import LinearResponse, linear_response, response_phase
from identification.models.phase import continuous_phase

BANDS = ("magnitude_lower95", "magnitude_upper95", "phase_lower95_rad", "phase_upper95_rad")


@dataclass(frozen=True)
class _Evaluated:
    """How a model answers at its operating point: G (F,), the covariance (F, 2, 2) of its parts where known, arg G."""

    sample_time: float | None
    response: Callable[[FloatArray], ComplexArray]
    covariance: Callable[[FloatArray], FloatArray] | None
    phase: Callable[[FloatArray], FloatArray]
    left_out: tuple[str, ...] = ()


def frequency_response(
    resources: ResourceRepository,
    model_id: str,
    point: list[float],
    band: tuple[float, float, int],
    channel: tuple[int, int],
) -> ModelFrequencyResponse:
    """The response of a model at one operating point over a band (lowest, highest, count), with 95 % bands."""
    document = get(resources, model_id)
    plant = get_plant(resources, document.plant_id)
    _check_channel(document, channel)
    with pointing({}, "/operatingPoint", "query"):
        model = _evaluated(document, plant, point, channel)
    omega, count = _frequencies(band, model.sample_time), band[2]
    with pointing({}, "/operatingPoint", "query"):
        response = model.response(omega)
        covariance = np.zeros((count, 2, 2)) if model.covariance is None else model.covariance(omega)
        if not (np.isfinite(response).all() and np.isfinite(covariance).all()):
            raise RangeError("the response is infinite in this band, e.g. at a pole; leave that frequency out")
        phase = model.phase(omega)
    known = model.covariance is not None
    return ModelFrequencyResponse(
        model_id=model_id,
        operating_point=point,
        output_number=channel[0],
        input_number=channel[1],
        frequencies_rad_per_second=omega.tolist(),
        response=ComplexVector.of(response),
        **_gain_and_phase(gain_and_phase(response, covariance, phase), known),
        **_covariance(covariance, known),
        left_out_effects=list(model.left_out),
    )


def _evaluated(document: Model, plant: Plant, point: list[float], channel: tuple[int, int]) -> _Evaluated:
    if document.effects:
        return _extended(document, plant, point)
    return _plain(document, plant, point, channel)


def _extended(document: Model, plant: Plant, point: list[float]) -> _Evaluated:
    model = extended_model(document, plant)
    known = model.joint_covariance is not None

    def found(omega: FloatArray) -> LinearResponse:
        return linear_response(model, [point], omega)

    def covariance(omega: FloatArray) -> FloatArray:
        parts = found(omega).covariance
        assert parts is not None, "the covariance of the parameters is known"
        return np.asarray(parts[0])

    left_out = tuple(effect.kind for effect in found(np.ones(1)).left_out)
    return _Evaluated(
        model.structure.sample_time,
        lambda omega: found(omega).response[0],
        covariance if known else None,
        lambda omega: response_phase(model, point, omega),
        left_out,
    )


def _plain(document: Model, plant: Plant, point: list[float], channel: tuple[int, int]) -> _Evaluated:
    y, u = (number - 1 for number in channel)
    model = kept_model(document, plant) if document.state_space is None else kept_state_space(document, plant)
    if model is None:
        local = kept_local(document, point)
        memory = local.order * (local.sample_time or 0.0)

        def of_local(omega: FloatArray) -> ComplexArray:
            return local.frequency_response(omega)[:, y, u]

        return _Evaluated(
            local.sample_time, of_local, None, lambda omega: continuous_phase(of_local, omega, memory=memory)
        )

    def response(omega: FloatArray) -> ComplexArray:
        return model.frequency_response([point], omega)[0, :, y, u]

    late = float(model.structure.dead_time(model.coefficients([point]))[0])
    return _Evaluated(
        model.structure.sample_time,
        response,
        None if document.covariance is None else lambda omega: model.response_covariance([point], omega)[0, :, y, u],
        lambda omega: continuous_phase(response, omega, late, model.structure.memory),
    )


def _check_channel(document: Model, channel: tuple[int, int]) -> None:
    found = document.state_space
    most = (1, 1) if found is None else (found.output_count, found.input_count)
    for name, number, count in zip(("output", "input"), channel, most, strict=True):
        if number > count:
            raise UnprocessableError.at(f"/{name}Number", f"the model has {count} {name}s", "query")


def _frequencies(band: tuple[float, float, int], step: float | None) -> FloatArray:
    minimum, maximum, count = band
    if minimum > maximum:
        raise UnprocessableError.at("/maximumRadPerSecond", "the band must rise", "query")
    if step is not None and maximum > np.pi / step * (1 + 1e-9):
        raise UnprocessableError.at(
            "/maximumRadPerSecond", f"lies above the Nyquist frequency {np.pi / step:.6g} rad/s", "query"
        )
    return np.geomspace(minimum, maximum, count) if minimum > 0 else np.linspace(minimum, maximum, count)


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
