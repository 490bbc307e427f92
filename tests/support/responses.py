"""A parameter-varying plant with two inputs and two outputs, and what is measured of it, as requests."""

import io

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.models.model import Model
from identification.models.state_space_model import state_space_model
from identification.scheduling import ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse
from tests.support.api import Json

SPEED = SchedulingVariable("speed", "m/s", 0.0, 2.0)
FREQUENCIES = np.linspace(0.05, 3.0, 60)
POINTS = (0.0, 0.7, 1.3, 2.0)
STRUCTURE: Json = {"timeDomain": "discreteStateSpace", "sampleTimeSeconds": 1.0, "order": 3}
AFFINE: Json = {"factors": [{"kind": "polynomial", "degree": 1}]}
CONSTANT: Json = {"factors": [{"kind": "polynomial", "degree": 0}]}
PLANT: Json = {
    "name": "two tanks",
    "schedulingVariables": [{"name": "speed", "unit": "m/s", "minimum": 0.0, "maximum": 2.0}],
    "inputs": [{"name": "valve", "unit": "V"}, {"name": "pump", "unit": "V"}],
    "outputs": [{"name": "level", "unit": "m"}, {"name": "flow", "unit": "m3/s"}],
    "structure": STRUCTURE,
    "basis": AFFINE,
    "coefficientBases": [{"coefficient": name, "basis": CONSTANT} for name in ("B", "C", "D")],
}


def true_plant() -> Model:
    """In observability canonical form: output 1 shows states 1 and 3, output 2 state 2; A is affine in the speed."""
    affine, constant = ProductBasis((Polynomial(1),)), ProductBasis((Polynomial(0),))
    a = np.array(
        [
            [[0.0, 0.0, 1.0], [0.1, 0.5, 0.05], [-0.55, 0.1, 1.2]],
            [[0.0, 0.0, 0.0], [0.02, 0.1, -0.03], [-0.08, 0.03, -0.15]],
        ]
    )
    b = np.array([[[1.0, 0.2], [0.3, -0.8], [0.5, 0.4]]])
    c = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
    d = np.array([[[0.0, 0.1], [0.2, 0.0]]])
    return state_space_model((SPEED,), (affine, constant, constant, constant), (a, b, c, d), 1.0)


def measured(point: float, deviation: float = 0.0, seed: int = 0) -> FrequencyResponse:
    """The response at an operating point, with circular noise of a standard deviation and its variance."""
    truth = true_plant().frequency_response([[point]], FREQUENCIES)[0]
    if deviation == 0.0:
        return FrequencyResponse(FREQUENCIES, truth, (point,), 1.0)
    parts = np.random.default_rng([seed, round(1000 * point)]).normal(scale=deviation / 2**0.5, size=(2, *truth.shape))
    return FrequencyResponse(
        FREQUENCIES, truth + parts[0] + 1j * parts[1], (point,), 1.0, np.full(truth.shape, deviation**2)
    )


def body(plant: Json, data: FrequencyResponse) -> Json:
    """The request that brings a response in as JSON."""
    return {
        "kind": "matrixFrequencyResponse",
        "plantId": plant["id"],
        "operatingPoint": list(data.operating_point),
        "sampleTimeSeconds": data.sample_time,
        "frequenciesRadPerSecond": data.frequencies.tolist(),
        "response": complex_json(data.response),
        "variance": None if data.variance is None else data.variance.tolist(),
    }


def complex_json(values: ComplexArray) -> Json:
    """{"re": …, "im": …}."""
    return {"re": values.real.tolist(), "im": values.imag.tolist()}


def complex_array(document: Json) -> ComplexArray:
    """The array of {"re": …, "im": …}."""
    return np.array(document["re"]) + 1j * np.array(document["im"])


def npz(**arrays: FloatArray | ComplexArray | float) -> bytes:
    """An npz file."""
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()
