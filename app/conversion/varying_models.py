"""Affine state-space models: documents to models and back."""

from typing import Any

import numpy as np

from app.arrays import ComplexVector, finite_list_or_none
from app.conversion.extremes import finite
from app.conversion.models import outcome_document, standard_deviations, test_documents
from app.conversion.plants import MATRIX_NAMES, scheduling_variables
from app.conversion.state_space import entry_names, kept_state_space, matrices_document, range_poles
from app.schemas.models import Model
from app.schemas.plants import (
    DiscreteStateSpaceStructure,
    Plant,
    ProductBasisDocument,
    StateSpaceStructureDocument,
)
from app.schemas.state_space import StateSpaceResult
from app.schemas.varying import EigenvaluesDocument, VaryingModelRequest
from identification.arrays import FloatArray, IntArray
from identification.errors import MisuseError
from identification.outcome import Outcome
from identification.parametric.pole_guarantee import fine_grid
from identification.varying.affine_estimate import AffineEstimate
from identification.varying.affine_parameters import AffineSizes
from identification.varying.affine_state_space import AffineStateSpace
from identification.varying.frozen import affine_model


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


def affine_basis(variables: int) -> ProductBasisDocument:
    """1 and each scheduling variable."""
    factors = [{"kind": "polynomial", "degree": 1}] * variables
    return ProductBasisDocument.model_validate({"factors": factors, "totalDegree": 1})


def model_parts(estimate: AffineEstimate) -> dict[str, Any]:
    """θ, its accuracy, outcome, tests and poles, as in every model document."""
    frozen = affine_model(estimate)
    theta = finite(frozen.theta, "matrices")
    covariance = None if estimate.covariance is None else finite(frozen.theta_covariance, "covariances")
    return {
        "coefficientNames": list(MATRIX_NAMES),
        "parameterNames": entry_names(frozen),
        "theta": theta.tolist(),
        "covariance": None if covariance is None else finite_list_or_none(covariance),
        "standardDeviations": None if covariance is None else standard_deviations(covariance),
        "noiseVariance": None,
        "outcome": outcome_document(estimate.outcome).as_json(),
        "tests": [test.as_json() for test in test_documents(estimate.tests)],
        "stable": bool(np.all(frozen.stable(fine_grid(frozen.variables)))),
        "poles": [poles.as_json() for poles in range_poles(frozen)],
    }


def state_space_part(model: AffineStateSpace) -> dict[str, Any]:
    """What every state-space model says of itself."""
    return StateSpaceResult(
        subspace_estimator=None,
        parametric_estimator=None,
        refinement=None,
        order=model.order,
        sample_time_seconds=model.sample_time,
        input_count=model.n_inputs,
        output_count=model.n_outputs,
        matrices=matrices_document(affine_model(AffineEstimate(model, Outcome("converged"), ()))),
        errors=[],
        singular_values=[],
        chosen_rows=None,
        pole_guarantee=None,
        local_models=[],
    ).as_json()


def kept_estimate(model: Model, plant: Plant) -> AffineEstimate:
    """The affine model of a document with its covariance; only for models from varying scheduling."""
    frozen = kept_state_space(model, plant)
    assert frozen is not None, "models from varying scheduling have matrices"
    sizes = AffineSizes.like(frozen)
    back = np.argsort(sizes.in_products)
    affine = sizes.model(frozen.theta[back], frozen.structure.sample_time or 0.0, scheduling_variables(plant))
    covariance = None if model.covariance is None else frozen.theta_covariance[np.ix_(back, back)]
    return AffineEstimate(affine, Outcome(model.outcome.status, model.outcome.advice), (), covariance)


def kept_joint_covariance(model: Model, plant: Plant) -> FloatArray | None:
    """The joint covariance of θ and the effects of a document, θ in the order of `AffineSizes`."""
    if model.joint_covariance is None:
        return None
    joint = np.array(model.joint_covariance)
    places = _joint_places(kept_estimate(model, plant).model, len(joint))
    return np.asarray(joint[np.ix_(np.argsort(places), np.argsort(places))])


def joint_document(model: AffineStateSpace, joint: FloatArray | None) -> Any:
    """The joint covariance of θ and the effects, θ in the order of documents."""
    if joint is None:
        return None
    places = _joint_places(model, len(joint))
    return finite_list_or_none(joint[np.ix_(places, places)])


def _joint_places(model: AffineStateSpace, size: int) -> IntArray:
    places = AffineSizes.of(model).in_products
    return np.concatenate([places, np.arange(len(places), size)])


def eigenvalue_documents(estimate: AffineEstimate) -> list[EigenvaluesDocument]:
    """The eigenvalues of each A_i; multiple ones have no covariance."""
    values = finite(estimate.model.eigenvalues(), "eigenvalues")
    shape = (*values.shape, 2, 2)
    known = estimate.covariance is not None
    covariance = estimate.eigenvalue_covariance() if known else np.full(shape, np.inf)
    names = ["1", *(variable.name for variable in estimate.model.variables)]
    return [
        EigenvaluesDocument(
            function=name,
            eigenvalues=ComplexVector.of(values[i]),
            real_variances=_known(covariance[i, :, 0, 0]),
            imaginary_variances=_known(covariance[i, :, 1, 1]),
            real_imaginary_covariances=_known(covariance[i, :, 0, 1]),
        )
        for i, name in enumerate(names)
    ]


def _known(values: FloatArray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def structure_document(asked: StateSpaceStructureDocument, model: AffineStateSpace) -> dict[str, Any]:
    """The structure with the order that the model has."""
    return {**asked.as_json(), "order": model.order}
