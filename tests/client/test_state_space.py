"""State-space models by a program that knows the service only through its generated client."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from tests.support import responses
from tests.support.client import Caller
from tests.support.server import Server


@pytest.fixture(scope="module")
def call(client_package: ModuleType, server: Server) -> Caller:
    return Caller(client_package, server.url)


@pytest.fixture(scope="module")
def plant(call: Caller) -> Any:
    m = call.m
    affine, constant = (
        m.ProductBasisDocument(factors=[m.PolynomialBasis(kind="polynomial", degree=degree)]) for degree in (1, 0)
    )
    body = m.PlantRequest(
        name="two tanks",
        scheduling_variables=[m.SchedulingVariableDocument(name="speed", minimum=0.0, maximum=2.0)],
        inputs=[m.SignalDescription(name="valve"), m.SignalDescription(name="pump")],
        outputs=[m.SignalDescription(name="level"), m.SignalDescription(name="flow")],
        structure=m.DiscreteStateSpaceStructure(time_domain="discreteStateSpace", sample_time_seconds=1.0, order=3),
        basis=affine,
        coefficient_bases=[m.CoefficientBasis(coefficient=name, basis=constant) for name in "BCD"],
    )
    return call("plants", "create_plant", body=body)


@pytest.fixture(scope="module")
def experiments(call: Caller, plant: Any) -> list[str]:
    m, names = call.m, []
    for point in responses.POINTS:
        data = responses.measured(point, 0.01)
        body = m.MatrixFrequencyResponseRequest(
            kind="matrixFrequencyResponse",
            plant_id=plant.id,
            operating_point=[point],
            sample_time_seconds=1.0,
            frequencies_rad_per_second=data.frequencies.tolist(),
            response=m.ComplexMatrices(re=data.response.real.tolist(), im=data.response.imag.tolist()),
            variance=data.variance.tolist(),
        )
        names.append(call.finished(call("experiments", "create_experiment", body=body)))
    return names


def test_the_plant_comes_back_as_typed_documents(call: Caller, plant: Any) -> None:
    found = call("plants", "get_plant", plant.id)
    assert isinstance(found.structure, call.m.DiscreteStateSpaceStructure)
    assert [signal.name for signal in found.outputs] == ["level", "flow"]
    assert not found.input_


def test_a_model_with_a_pole_region_comes_back_as_typed_documents(
    call: Caller, plant: Any, experiments: list[str]
) -> None:
    m = call.m
    parts = [m.DiscRegion(kind="disc", radius=0.95), m.StripRegion(kind="strip", half_height=0.9)]
    body = m.StateSpaceModelRequest(
        kind="stateSpace",
        plant_id=plant.id,
        experiment_ids=experiments,
        subspace_estimator=m.FrequencySubspaceEstimator(kind="frequency_subspace"),
        parametric_estimator=m.ParametricSubspaceEstimator(
            kind="parametric_subspace", region=m.IntersectionRegion(kind="intersection", regions=parts)
        ),
    )
    model = call("models", "get_model", call.finished(call("models", "create_model", body=body)))
    found = model.state_space
    assert isinstance(found.parametric_estimator.region.regions[1], m.StripRegion)
    assert found.pole_guarantee.guaranteed == "wholeRange"
    assert np.array(found.matrices.matrix_a).shape == (2, 3, 3)
    assert [local.order for local in found.local_models] == [3] * len(experiments)
    assert not model.noise_variance
    band = {"minimum_rad_per_second": 0.1, "maximum_rad_per_second": 3.0, "count": 20}
    response = call("models", "get_model_frequency_response", model.id, operating_point=[1.0], input_number=2, **band)
    truth = responses.true_plant().frequency_response([[1.0]], response.frequencies_rad_per_second)[0, :, 0, 1]
    values = np.array(response.response.re) + 1j * np.array(response.response.im)
    assert np.linalg.norm(values - truth) < 0.05 * np.linalg.norm(truth)
