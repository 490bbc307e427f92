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
from app.schemas.models import Model
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
from identification.models.system import StateSpace
from identification.parameter_varying import ParameterVaryingStateSpace
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


def kept_state_space(model: Model, plant: Plant) -> ParameterVaryingStateSpace | None:
    """The parameter-varying state-space model of a document, None when it has none."""
    found = model.state_space
    if found is None or found.matrices is None:
        return None
    dependence = parameter_dependence(MATRIX_NAMES, plant.scheduling_variables, model.basis, model.coefficient_bases)
    a, b, c, d = (np.array(getattr(found.matrices, f"matrix_{name}"), dtype=float) for name in "abcd")
    return ParameterVaryingStateSpace(dependence.variables, dependence.bases, a, b, c, d, found.sample_time_seconds)


def kept_local(model: Model, point: Sequence[float]) -> StateSpace:
    """The local model at an operating point; raises MisuseError when there is none."""
    assert model.state_space is not None, "asked for state-space models only"
    local = model.state_space.local_models
    for one in local:
        if np.allclose(one.operating_point, point, rtol=1e-9, atol=0.0):
            a, b, c, d = (np.array(getattr(one, f"matrix_{name}"), dtype=float) for name in "abcd")
            return StateSpace(a, b, c, d, one.sample_time_seconds)
    known = "; ".join(", ".join(f"{value:g}" for value in one.operating_point) for one in local[:10])
    raise MisuseError(f"this model is one of single operating points only; choose one of them: {known}")


def entry_names(model: ParameterVaryingStateSpace) -> list[str]:
    """A name for each entry of θ, such as A[1](2,3): function 1, row 2, column 3."""
    names = []
    for name, matrices, basis in zip(
        MATRIX_NAMES, (model.a, model.b, model.c, model.d), model.dependence.bases, strict=True
    ):
        _, rows, columns = matrices.shape
        places = [(i + 1, k + 1) for i in range(rows) for k in range(columns)]
        names += [f"{name}[{label}]({i},{k})" for label in basis.labels for i, k in places]
    return names


def matrices_document(model: ParameterVaryingStateSpace) -> MatricesDocument:
    """The matrices of each function."""
    return MatricesDocument(
        matrix_a=model.a.tolist(), matrix_b=model.b.tolist(), matrix_c=model.c.tolist(), matrix_d=model.d.tolist()
    )


def range_poles(model: ParameterVaryingStateSpace) -> list[PolesAtPoint]:
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
