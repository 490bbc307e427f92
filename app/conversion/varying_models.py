"""State-space models from varying scheduling: documents to models and back."""

from typing import Any

import numpy as np

from app.arrays import ComplexVector, finite_list_or_none
from app.conversion.extremes import finite
from app.conversion.models import outcome_document, standard_deviations, test_documents
from app.conversion.plants import MATRIX_NAMES
from app.conversion.state_space import entry_names, kept_state_space, matrices_document, range_poles
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import (
    DiscreteStateSpaceStructure,
    Plant,
    ProductBasisDocument,
    StateSpaceStructureDocument,
)
from app.schemas.state_space import StateSpaceResult
from app.schemas.varying import EigenvaluesDocument, VaryingModelRequest
from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, ShapeError
from identification.models.model import Model
from identification.outcome import Outcome, TestResult
from identification.parametric.pole_guarantee import fine_grid
from identification.varying.eigenvalues import eigenvalue_covariance, eigenvalues


def requested_structure(plant: Plant, request: VaryingModelRequest) -> DiscreteStateSpaceStructure:
    """The structure of the model asked for; raises MisuseError unless it is a state-space one in discrete time."""
    structure = request.structure or plant.structure
    if not isinstance(structure, DiscreteStateSpaceStructure):
        raise MisuseError(
            "the structure of the plant is not that of a state-space model in discrete time; state one here, e.g."
            ' {"timeDomain": "discreteStateSpace", "sampleTimeSeconds": …, "order": 2}',
            "structure",
        )
    return structure


def requested_basis(plant: Plant, request: VaryingModelRequest) -> ProductBasisDocument:
    """The functions that the matrices are sums over: 1 and each scheduling variable when none are stated.

    Raises ShapeError for another number of factors than scheduling variables.
    """
    variables = len(plant.scheduling_variables)
    if request.basis is not None:
        if len(request.basis.factors) != variables:
            raise ShapeError(f"the basis has {len(request.basis.factors)} factors; give {variables}", "basis")
        return request.basis
    factors = [{"kind": "polynomial", "degree": 1}] * variables
    return ProductBasisDocument.model_validate({"factors": factors, "totalDegree": 1})


def model_parts(model: Model, outcome: Outcome, tests: tuple[TestResult, ...] = ()) -> dict[str, Any]:
    """θ, its accuracy, outcome, tests and poles, as in every model document."""
    theta = finite(model.theta, "matrices")
    covariance = None if model.covariance is None else finite(model.theta_covariance, "covariances")
    return {
        "coefficientNames": list(MATRIX_NAMES),
        "parameterNames": entry_names(model),
        "theta": theta.tolist(),
        "covariance": None if covariance is None else finite_list_or_none(covariance),
        "standardDeviations": None if covariance is None else standard_deviations(covariance),
        "noiseVariance": None,
        "outcome": outcome_document(outcome).as_json(),
        "tests": [test.as_json() for test in test_documents(tests)],
        "stable": bool(np.all(model.stable(fine_grid(model.variables)))),
        "poles": [poles.as_json() for poles in range_poles(model)],
    }


def state_space_part(model: Model) -> dict[str, Any]:
    """What every state-space model says of itself."""
    return StateSpaceResult(
        subspace_estimator=None,
        parametric_estimator=None,
        refinement=None,
        order=model.structure.order,
        sample_time_seconds=model.structure.sample_time,
        input_count=model.structure.inputs,
        output_count=model.structure.outputs,
        matrices=matrices_document(model),
        errors=[],
        singular_values=[],
        chosen_rows=None,
        pole_guarantee=None,
        local_models=[],
    ).as_json()


def kept_varying(document: ModelDocument, plant: Plant) -> Model:
    """The model of a document with its covariance; only for models from varying scheduling."""
    model = kept_state_space(document, plant)
    assert model is not None, "models from varying scheduling have matrices"
    return model


def eigenvalue_documents(model: Model) -> list[EigenvaluesDocument]:
    """The eigenvalues of each A_j; multiple ones have no covariance."""
    values = finite(eigenvalues(model), "eigenvalues")
    shape = (*values.shape, 2, 2)
    covariance = np.full(shape, np.inf) if model.covariance is None else eigenvalue_covariance(model)
    return [
        EigenvaluesDocument(
            function=name,
            eigenvalues=ComplexVector.of(values[i]),
            real_variances=_known(covariance[i, :, 0, 0]),
            imaginary_variances=_known(covariance[i, :, 1, 1]),
            real_imaginary_covariances=_known(covariance[i, :, 0, 1]),
        )
        for i, name in enumerate(function_names(model))
    ]


def function_names(model: Model) -> list[str]:
    """What each A_j is multiplied by: products of powers by their names, other functions by their indices."""
    basis, names = model.dependence.bases[0], [variable.name for variable in model.variables]
    if not all(isinstance(factor, Polynomial) for factor in basis.factors):
        return [f"[{label}]" for label in basis.labels]
    return [_product(names, label.split(",")) for label in basis.labels]


def _product(names: list[str], powers: list[str]) -> str:
    parts = [
        name if power == "1" else f"{name}^{power}" for name, power in zip(names, powers, strict=True) if power != "0"
    ]
    return " ".join(parts) or "1"


def _known(values: FloatArray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def structure_document(asked: StateSpaceStructureDocument, model: Model) -> dict[str, Any]:
    """The structure with the order that the model has."""
    return {**asked.as_json(), "order": model.structure.order}
