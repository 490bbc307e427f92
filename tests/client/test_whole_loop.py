"""The whole loop by a program that knows the service only through its generated client."""

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from identification.arrays import FloatArray
from tests.support import client
from tests.support.client import Caller
from tests.support.paper import DEVIATIONS, NOISE_VARIANCE, THETA, played
from tests.support.server import Server

ELLIPSOID = 22.46  # 99.9 % quantile of χ²(6)


@pytest.fixture(scope="module")
def call(client_package: ModuleType, server: Server) -> Caller:
    return Caller(client_package, server.url)


@pytest.fixture(scope="module")
def plant(call: Caller) -> Any:
    m = call.m
    body = m.PlantRequest(
        name="the example of Ghosh et al.",
        scheduling_variables=[m.SchedulingVariableDocument(name="p", minimum=0.0, maximum=8.0)],
        input_=m.SignalDescription(name="u"),
        output=m.SignalDescription(name="y"),
        structure=m.DiscreteTimeStructure(time_domain="discrete", sample_time_seconds=1.0, na=1, nb=0, nk=1, nd=1),
        basis=m.ProductBasisDocument(factors=[m.PolynomialBasis(kind="polynomial", degree=1)]),
    )
    return call("plants", "create_plant", body=body)


@pytest.fixture(scope="module")
def design(call: Caller, plant: Any) -> Any:
    m = call.m
    stated = m.StatedModelRequest(plant_id=plant.id, theta=THETA, noise_variance=NOISE_VARIANCE)
    model = call("models", "state_model", body=stated)
    assert model.parameter_names == plant.parameter_names
    body = m.DesignRequest(
        plant_id=plant.id,
        model_id=model.id,
        operating_points=m.AxesGrid(kind="gridAxes", axes=[m.GridAxis(minimum=0.0, maximum=8.0, count=17)]),
        targets=[m.ParameterDeviationTarget(kind="parameter_deviation", standard_deviations=DEVIATIONS)],
        spectrum_family=m.FirSpectraFamily(kind="fir", degree=10),
        samples=1000,
    )
    return call("designs", "get_design", call.finished(call("designs", "create_design", body=body)))


@pytest.fixture(scope="module")
def records(call: Caller, design: Any) -> list[tuple[float, FloatArray, FloatArray]]:
    """Operating point, input and output of the designed experiments, played on the simulated plant."""
    body = call.m.SignalsRequest(periods=2, seed=1)
    job = call("designs", "create_signals", design.id, body=body)
    signals = call("signals", "get_signals", call.finished(job))
    generator, made = np.random.default_rng(7), []
    for signal in signals.signals:
        file = call("signals", "get_signal_file", signals.id, index=signal.index).payload
        with np.load(file) as arrays:
            u = np.asarray(arrays["input"])
        made.append((signal.operating_point[0], u, played(signal.operating_point[0], u, generator)))
    return made


@pytest.fixture(scope="module")
def experiments(call: Caller, design: Any, records: list[tuple[float, FloatArray, FloatArray]]) -> list[Any]:
    m = call.m
    jobs = []
    for point, u, y in records:
        body = m.TimeRecordRequest(
            kind="timeRecord",
            plant_id=design.request.plant_id,
            design_id=design.id,
            operating_point=[point],
            sample_time_seconds=1.0,
            input_=u.tolist(),
            output=y.tolist(),
        )
        jobs.append(call("experiments", "create_experiment", body=body))
    return [call("experiments", "get_experiment", call.finished(job)) for job in jobs]


@pytest.fixture(scope="module")
def model(call: Caller, plant: Any, experiments: list[Any]) -> Any:
    m = call.m
    body = m.ModelRequest(
        kind="rational",
        plant_id=plant.id,
        experiment_ids=[experiment.id for experiment in experiments],
        local_estimator=m.PredictionErrorEstimator(kind="prediction_error"),
        lpv_estimator=m.JointLikelihoodEstimator(kind="joint_likelihood"),
    )
    return call("models", "get_model", call.finished(call("models", "create_model", body=body)))


def test_the_design_comes_back_as_typed_documents(call: Caller, design: Any) -> None:
    assert design.outcome.status is call.m.OutcomeDocumentStatus.CONVERGED
    assert 0 <= design.gap <= 1e-4
    assert [e.operating_point for e in design.experiments] == [[0.0], [1.5], [8.0]]
    assert isinstance(design.experiments[0].spectrum, call.m.FirSpectrumDocument)
    assert isinstance(design.request.targets[0], call.m.ParameterDeviationTarget)


def test_an_experiment_is_understood_as_it_was_sent(experiments: list[Any]) -> None:
    for experiment in experiments:
        assert experiment.understood.samples == 1000
        assert experiment.understood.period_samples == 500


def test_the_model_has_the_accuracy_asked_for(model: Any) -> None:
    covariance = np.array(model.covariance)
    error = np.array(model.theta) - THETA
    assert covariance.shape == (6, 6)
    assert error @ np.linalg.solve(covariance, error) < ELLIPSOID
    assert np.linalg.eigvalsh(covariance / np.outer(DEVIATIONS, DEVIATIONS))[-1] <= 1.2
    assert len(model.local_models) == 3


def test_the_model_can_be_evaluated(call: Caller, model: Any) -> None:
    answer = call(
        "models",
        "get_model_frequency_response",
        model.id,
        operating_point=[0.0],
        minimum_rad_per_second=0.01,
        maximum_rad_per_second=3.0,
        count=30,
    )
    q = np.exp(-1j * np.array(answer.frequencies_rad_per_second))
    found = np.array(answer.response.re) + 1j * np.array(answer.response.im)
    np.testing.assert_allclose(found, 10 * q / (1 - 0.9 * q), rtol=0.05)


def test_a_file_is_uploaded_and_taken_out_again(
    call: Caller, plant: Any, records: list[tuple[float, FloatArray, FloatArray]]
) -> None:
    point, u, y = records[0]
    lines = "\n".join(f"{t},{a!r},{b!r}" for t, (a, b) in enumerate(zip(u.tolist(), y.tolist(), strict=True)))
    file = client.file(call.package, f"time,input,output\n{lines}\n".encode(), "record.csv")
    body = call.m.BodyUploadExperiment(file=file, plant_id=plant.id, operating_point=[point])
    made = call.finished(call("experiments", "upload_experiment", body=body))
    data = call("experiments", "get_experiment_data", made)
    assert data.output == y.tolist()


def test_a_problem_is_a_typed_document_too(call: Caller, plant: Any) -> None:
    body = call.m.StatedModelRequest(plant_id=plant.id, theta=THETA[:-1], noise_variance=NOISE_VARIANCE)
    answer = client.operation(call.package, "models", "state_model").sync_detailed(client=call.client, body=body)
    assert answer.status_code == 422
    assert isinstance(answer.parsed, call.m.Problem)
    assert [error.pointer for error in answer.parsed.errors] == ["/theta"]
