"""Models: documents to objects, estimates to documents."""

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np

from app.arrays import ComplexVector, finite_list_or_none, finite_or_none
from app.conversion.extremes import finite
from app.conversion.plants import lpv_model, parameter_dependence, rational_of
from app.schemas.models import LocalModelDocument, ModelRequest
from app.schemas.models import Model as ModelDocument
from app.schemas.outcomes import OutcomeDocument, PolesAtPoint, TestDocument
from app.schemas.plants import CoefficientBasis, Plant, ProductBasisDocument, Structure
from app.schemas.state_space import StateSpaceModelRequest
from identification.arrays import FloatArray
from identification.errors import RangeError
from identification.estimates import LocalEstimate
from identification.models.model import Model
from identification.models.physical import RationalForm
from identification.outcome import Outcome, TestResult
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse, Measurement

POLE_POINTS = 101
STABILITY_POINTS = 1000


def chosen(
    plant: Plant, request: ModelRequest | StateSpaceModelRequest
) -> tuple[Structure, ProductBasisDocument, list[CoefficientBasis]]:
    """Structure, basis and exceptions of the model asked for: those of the plant unless the request has its own."""
    own = request.coefficient_bases
    if own is None:
        own = plant.coefficient_bases if request.structure is None and request.basis is None else []
    return request.structure or plant.structure, request.basis or plant.basis, own


def requested_structure(plant: Plant, request: ModelRequest) -> tuple[RationalForm, ParameterDependence]:
    """Structure and dependence of the model asked for."""
    document, basis, own = chosen(plant, request)
    structure = rational_of(document)
    return structure, parameter_dependence(structure.coefficient_names, plant.scheduling_variables, basis, own)


def kept_model(model: ModelDocument, plant: Plant) -> Model:
    """The model of a document; one without a covariance is taken as exactly known.

    Raises MisuseError for a state-space model.
    """
    structure = rational_of(model.structure)
    names = structure.coefficient_names
    dependence = parameter_dependence(names, plant.scheduling_variables, model.basis, model.coefficient_bases)
    assert model.noise_variance is not None, "rational models have one"
    return lpv_model(structure, dependence, model.theta, model.covariance, model.noise_variance)


def standard_deviations(covariance: FloatArray) -> list[float] | None:
    """Square roots of the diagonal, or null when a variance is not finite."""
    result: list[float] | None = finite_list_or_none(np.sqrt(np.maximum(np.diagonal(covariance), 0.0)))
    return result


def outcome_document(outcome: Outcome) -> OutcomeDocument:
    """How a computation ended."""
    return OutcomeDocument(status=outcome.status, advice=outcome.advice, iterations=outcome.iterations)


def test_documents(tests: tuple[TestResult, ...]) -> list[TestDocument]:
    """Test results, with null for what is not a number."""
    return [
        TestDocument(
            name=test.name,
            statistic=finite_or_none(test.statistic),
            degrees_of_freedom=finite_or_none(test.degrees_of_freedom),
            p_value=finite_or_none(test.p_value),
        )
        for test in tests
    ]


def local_document(estimate: LocalEstimate, data: Measurement | None, experiment_id: str | None) -> LocalModelDocument:
    """The local model, with its relative error where it was fitted to a frequency response."""
    model = estimate.model
    return LocalModelDocument(
        operating_point=list(model.operating_point),
        zeta=model.zeta.tolist(),
        standard_deviations=standard_deviations(model.covariance),
        covariance=finite_list_or_none(model.covariance),
        noise_variance=finite_or_none(model.noise_variance),
        outcome=outcome_document(estimate.outcome),
        tests=test_documents(estimate.tests),
        fit_percent=finite_or_none(estimate.fit_percent),
        relative_error=_relative_error(estimate, data),
        stable=bool(model.structure.stable(model.zeta)),
        experiment_id=experiment_id,
    )


def _relative_error(estimate: LocalEstimate, data: Measurement | None) -> float | None:
    """√(mean |Ĝ − G|²/|Ĝ|²) over the frequencies at which Ĝ is not zero."""
    if not isinstance(data, FrequencyResponse):
        return None
    response = estimate.model.structure.plant_response(estimate.model.zeta, data.frequencies, data.held)
    seen = data.response != 0
    return finite_or_none(float(np.sqrt(np.mean(abs(1 - response[seen] / data.response[seen]) ** 2))))


def range_documents(model: Model, coefficients_at: Callable[[FloatArray], FloatArray] | None = None) -> dict[str, Any]:
    """`stable` over the range of the scheduling variables, and `poles` for one variable.

    Raises RangeError where coefficients or poles are too large for a number.
    """
    variables = model.dependence.variables
    count = POLE_POINTS if len(variables) == 1 else max(2, int(STABILITY_POINTS ** (1 / len(variables))))
    axes = [np.linspace(v.minimum, v.maximum, count) for v in variables]
    points = np.array(list(product(*axes)))
    coefficients = finite((coefficients_at or model.coefficients)(points), "coefficients")
    poles = []
    if len(variables) == 1 and model.structure.order > 0:
        pairs = zip(points, finite(model.structure.poles(coefficients), "poles"), strict=True)
        poles = [PolesAtPoint(operating_point=p.tolist(), poles=ComplexVector.of(values)) for p, values in pairs]
    return {"stable": bool(np.all(model.structure.stable(coefficients))), "poles": poles}


def accuracy_documents(model: Model) -> dict[str, Any]:
    """θ, its covariance and standard deviations, σ_e²."""
    return {
        "theta": model.theta.tolist(),
        "covariance": finite_list_or_none(model.theta_covariance),
        "standardDeviations": standard_deviations(model.theta_covariance),
        "noiseVariance": float(model.noise_variance),
    }


def check_covariance(covariance: FloatArray) -> None:
    """Raises RangeError unless a covariance is symmetric and positive semidefinite."""
    scale = abs(covariance).max(initial=0.0)
    if not np.allclose(covariance, covariance.T, atol=1e-9 * scale):
        raise RangeError("the covariance is not symmetric", "covariance")
    if np.linalg.eigvalsh(covariance).min(initial=0.0) < -1e-9 * scale:
        raise RangeError("the covariance is not positive semidefinite", "covariance")
