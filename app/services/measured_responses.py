"""The frequency response of an experiment as it was measured, and whether an impedance can be one."""

import numpy as np

from app.arrays import ComplexVector
from app.container import Container
from app.conversion.experiments import kept_measurement
from app.errors import UnprocessableError
from app.schemas.experiments import Experiment
from app.schemas.measured_responses import KramersKronigDocument, MeasuredResponseDocument, Method
from app.schemas.plants import Plant
from app.services import plants
from app.services.experiments import KIND, experiment_of
from identification.errors import MisuseError
from identification.measurements.kramers_kronig import linear_kramers_kronig
from identification.measurements.measured_response import LEAST_PERIODS, measured_response
from identification.signals import FrequencyResponse, TimeRecord

PREFIXES = ("", "n", "µ", "u", "m", "k")


def measured(container: Container, experiment_id: str) -> MeasuredResponseDocument:
    """The response of an experiment of one channel; raises UnprocessableError where none can be had."""
    resource = container.resources.get(KIND, experiment_id)
    assert resource.arrays is not None, "experiments have arrays"
    experiment = experiment_of(resource)
    if experiment.kind not in ("timeRecord", "frequencyResponse"):
        raise _refused("only experiments of one channel at one operating point have one response")
    data = kept_measurement(experiment, container.arrays.get(resource.arrays))
    response = _response(data) if isinstance(data, TimeRecord) else data
    plant = plants.get(container.resources, experiment.plant_id)
    deviation = None if response.variance is None else np.sqrt(response.variance).tolist()
    return MeasuredResponseDocument(
        experiment_id=experiment_id,
        method=_method(experiment, data),
        frequencies_rad_per_second=response.frequencies.tolist(),
        response=ComplexVector.of(response.response),
        standard_deviation=deviation,
        kramers_kronig=_kramers_kronig(response) if is_impedance(plant) else None,
    )


def is_impedance(plant: Plant) -> bool:
    """Whether the response of a plant is an impedance, by its units: volts by amperes, or ohms."""
    if plant.input is None or plant.output is None:
        return False
    output, input = plant.output.unit.strip(), plant.input.unit.strip()
    volts, amperes = ({prefix + unit for prefix in PREFIXES} for unit in ("V", "A"))
    ohms = {prefix + unit for prefix in (*PREFIXES, "M") for unit in ("Ω", "Ω", "ohm", "Ohm")}
    return (output in volts and input in amperes) or (output in ohms and input in ("", "1"))


def _response(record: TimeRecord) -> FrequencyResponse:
    try:
        return measured_response(record)
    except MisuseError as error:
        raise _refused(f"no response can be had from this record: {error}") from error


def _method(experiment: Experiment, data: TimeRecord | FrequencyResponse) -> Method:
    if not isinstance(data, TimeRecord):
        return "given"
    periods = experiment.understood.periods or 0
    return "periodicAverage" if periods >= LEAST_PERIODS else "localPolynomial"


def _kramers_kronig(response: FrequencyResponse) -> KramersKronigDocument | None:
    try:
        found = linear_kramers_kronig(response)
    except MisuseError:
        return None
    return KramersKronigDocument(
        residual=ComplexVector.of(found.residual),
        size=found.size,
        conjugate_size=found.conjugate_size,
        degrees_of_freedom=found.degrees_of_freedom,
        p_value=found.p_value,
    )


def _refused(why: str) -> UnprocessableError:
    return UnprocessableError.at("/experimentId", why, "path")
