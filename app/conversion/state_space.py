"""State-space models: documents to objects, estimates to documents."""

from collections.abc import Sequence

import numpy as np

from app.arrays import ComplexVector, finite_or_none
from app.conversion.extremes import finite
from app.conversion.models import POLE_POINTS, chosen, outcome_document
from app.conversion.plants import (
    MATRIX_NAMES,
    is_state_space,
    parameter_dependence,
    state_space_dependence,
)
from app.schemas.models import Model as ModelDocument
from app.schemas.outcomes import PolesAtPoint
from app.schemas.plants import Plant, StateSpaceStructureDocument
from app.schemas.state_space import (
    LocalStateSpaceModel,
    MatricesDocument,
    OrderTrialDocument,
    ResponseErrorDocument,
    StateSpaceModelRequest,
)
from identification.errors import MisuseError
from identification.models.model import Model
from identification.models.state_space_model import stacks, state_space_model
from identification.models.system import StateSpace
from identification.parametric.estimate import ResponseError
from identification.scheduling import ParameterDependence
from identification.subspace.result import SubspaceEstimate


def requested_state_space(
    plant: Plant, request: StateSpaceModelRequest
) -> tuple[StateSpaceStructureDocument, ParameterDependence]:
    """Structure and dependence of the model asked for; raises MisuseError when the structure is a rational one."""
    structure, basis, own = chosen(plant, request)
    if not is_state_space(structure):
        raise MisuseError(
            "the plant has a rational structure; give a state-space structure here, or identify with /v1/models",
            "structure",
        )
    return structure, state_space_dependence(plant, structure, basis, own)


def kept_state_space(document: ModelDocument, plant: Plant) -> Model | None:
    """The parameter-varying state-space model of a document, None when it has none.

    One without a covariance is taken as exactly known.
    """
    found = document.state_space
    if found is None or found.matrices is None:
        return None
    asked = plant.scheduling_variables
    dependence = parameter_dependence(MATRIX_NAMES, asked, document.basis, document.coefficient_bases)
    a, b, c, d = (np.array(getattr(found.matrices, f"matrix_{name}"), dtype=float) for name in "abcd")
    known = None if document.covariance is None else np.array(document.covariance, dtype=float)
    noise = document.noise_variance or 1.0
    return state_space_model(
        dependence.variables, dependence.bases, (a, b, c, d), found.sample_time_seconds, known, noise
    )


def kept_local(document: ModelDocument, point: Sequence[float]) -> StateSpace:
    """The local model at an operating point; raises MisuseError when there is none."""
    assert document.state_space is not None, "asked for state-space models only"
    local = document.state_space.local_models
    for one in local:
        if np.allclose(one.operating_point, point, rtol=1e-9, atol=0.0):
            a, b, c, d = (np.array(getattr(one, f"matrix_{name}"), dtype=float) for name in "abcd")
            return StateSpace(a, b, c, d, one.sample_time_seconds)
    known = "; ".join(", ".join(f"{value:g}" for value in one.operating_point) for one in local[:10])
    raise MisuseError(f"this model is one of single operating points only; choose one of them: {known}")


def entry_names(model: Model) -> list[str]:
    """A name for each entry of θ, such as A[1](2,3): function 1, row 2, column 3."""
    groups = zip(model.structure.groups, model.dependence.bases, strict=True)
    return [
        entry.replace(group.name, f"{group.name}[{label}]")
        for group, basis in groups
        for label in basis.labels
        for entry in group.entries
    ]


def matrices_document(model: Model) -> MatricesDocument:
    """The matrices of each function."""
    a, b, c, d = (part.tolist() for part in stacks(model))
    return MatricesDocument(matrix_a=a, matrix_b=b, matrix_c=c, matrix_d=d)


def range_poles(model: Model) -> list[PolesAtPoint]:
    """The poles over the range of one scheduling variable; raises RangeError where they are no numbers."""
    if len(model.variables) > 1:
        return []
    points = np.linspace(model.variables[0].minimum, model.variables[0].maximum, POLE_POINTS)[:, None]
    pairs = zip(points, finite(model.poles(points), "poles"), strict=True)
    return [PolesAtPoint(operating_point=p.tolist(), poles=ComplexVector.of(values)) for p, values in pairs]


def error_document(error: ResponseError, experiment_id: str) -> ResponseErrorDocument:
    """The errors at one operating point."""
    return ResponseErrorDocument(
        experiment_id=experiment_id,
        operating_point=list(error.operating_point),
        max_error=error.maximum,
        rms_error=error.rms,
        relative_error=finite_or_none(error.relative),
    )


def local_document(estimate: SubspaceEstimate, experiment_id: str) -> LocalStateSpaceModel:
    """The model of one operating point with its errors and the table of orders."""
    model, point = estimate.model, list(estimate.operating_point)
    trials = [
        OrderTrialDocument(
            order=trial.order,
            singular_value=trial.singular_value,
            rms_error=trial.rms_error,
            held_out_rms_error=trial.held_out_rms_error,
            held_out_max_error=trial.held_out_max_error,
            stable=trial.stable,
        )
        for trial in estimate.orders
    ]
    return LocalStateSpaceModel(
        experiment_id=experiment_id,
        operating_point=point,
        order=model.order,
        sample_time_seconds=model.sample_time,
        matrix_a=model.a.tolist(),
        matrix_b=model.b.tolist(),
        matrix_c=model.c.tolist(),
        matrix_d=model.d.tolist(),
        poles=PolesAtPoint(operating_point=point, poles=ComplexVector.of(model.poles)),
        stable=bool(model.stable),
        outcome=outcome_document(estimate.outcome),
        block_rows=estimate.block_rows,
        singular_values=finite(estimate.singular_values, "singular values").tolist(),
        order_table=trials,
        max_error=estimate.max_error,
        rms_error=estimate.rms_error,
        relative_error=estimate.relative_error,
    )
