"""What an identification of state-space models found, as the parts of a model document."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.arrays import finite_list_or_none
from app.conversion.extremes import finite
from app.conversion.models import chosen, outcome_document, standard_deviations, test_documents
from app.conversion.plants import MATRIX_NAMES, channels, is_state_space, sample_time
from app.conversion.state_space import entry_names, error_document, local_document, matrices_document, range_poles
from app.schemas.outcomes import PolesAtPoint
from app.schemas.plants import Plant
from app.schemas.plug_ins import PlugInDocument
from app.schemas.state_space import (
    ChosenRows,
    PoleGuarantee,
    SingularValues,
    StateSpaceModelRequest,
    StateSpaceResult,
)
from identification.estimates import Estimate
from identification.models.model import Model
from identification.outcome import Outcome
from identification.parametric.estimate import ParametricEstimate, RegionReport, overall_error, response_errors
from identification.parametric.pole_guarantee import fine_grid, worst_excess
from identification.signals import FrequencyResponse
from identification.subspace.result import SubspaceEstimate


@dataclass(frozen=True, eq=False)
class Found:
    """The data, and what was identified from it; None and empty where it was not asked for."""

    data: Sequence[FrequencyResponse]
    experiment_ids: Sequence[str]
    local: Sequence[SubspaceEstimate]
    parametric: ParametricEstimate | None
    refined: Estimate | None

    @property
    def model(self) -> Model | None:
        """The parameter-varying model in its last form."""
        last = self.refined or self.parametric
        return None if last is None else last.model

    @property
    def outcome(self) -> Outcome:
        """That of the parameter-varying model, else the first of the local ones that is not as it should be."""
        last = self.refined or self.parametric
        if last is not None:
            return last.outcome
        outcomes = [estimate.outcome for estimate in self.local]
        return next((outcome for outcome in outcomes if not outcome.ok), outcomes[0])


def model_documents(found: Found) -> dict[str, Any]:
    """θ, its accuracy, outcome, tests and poles."""
    model, refined = found.model, found.refined
    covariance = None if refined is None else finite(refined.model.theta_covariance, "covariances")
    return {
        "coefficientNames": list(MATRIX_NAMES),
        "parameterNames": [] if model is None else entry_names(model),
        "theta": [] if model is None else finite(model.theta, "matrices").tolist(),
        "covariance": None if covariance is None else finite_list_or_none(covariance),
        "standardDeviations": None if covariance is None else standard_deviations(covariance),
        "noiseVariance": None if refined is None else refined.model.noise_variance,
        "outcome": outcome_document(found.outcome).as_json(),
        "tests": [] if refined is None else [test.as_json() for test in test_documents(refined.tests)],
        "stable": _stable(found),
        "poles": [poles.as_json() for poles in _poles(found)],
    }


def state_space_result(
    plant: Plant, request: StateSpaceModelRequest, found: Found, guarantee: PoleGuarantee | None
) -> dict[str, Any]:
    """The part of the document that state-space models have only."""
    model, parametric, ids = found.model, found.parametric, found.experiment_ids
    structure = chosen(plant, request)[0]
    assert is_state_space(structure), "checked when the job began"
    outputs, inputs = channels(plant)
    errors = [] if model is None else response_errors(model, found.data)
    result = StateSpaceResult(
        subspace_estimator=request.subspace_estimator,
        parametric_estimator=request.parametric_estimator,
        refinement=request.refinement,
        order=None if model is None else model.structure.order,
        sample_time_seconds=sample_time(structure),
        input_count=inputs,
        output_count=outputs,
        matrices=None if model is None else matrices_document(model),
        errors=[error_document(error, name) for error, name in zip(errors, ids, strict=model is not None)],
        singular_values=[] if parametric is None else _singular_values(parametric),
        chosen_rows=None if parametric is None else _rows(parametric),
        pole_guarantee=guarantee,
        local_models=[local_document(one, name) for one, name in zip(found.local, ids, strict=bool(found.local))],
    )
    return result.as_json()


def refined_guarantee(refinement: PlugInDocument | None, found: Found) -> PoleGuarantee | None:
    """What is known of the poles of the last form of the model with regard to its region, None without one."""
    report = None if found.parametric is None else found.parametric.region
    if found.refined is None:
        return None if report is None else _guarantee(report)
    region = None if refinement is None else refinement.build().region
    if region is None:
        return None
    model = found.refined.model
    return PoleGuarantee(
        guaranteed="grid",
        operating_points=len(fine_grid(model.variables)),
        certificate=None,
        worst_excess=worst_excess(model, region)[0],
        worst_excess_without_region=None,
        relative_error=overall_error(model, found.data),
        relative_error_without_region=None,
    )


def _guarantee(report: RegionReport) -> PoleGuarantee:
    return PoleGuarantee(
        guaranteed="wholeRange" if report.where == "whole range" and report.certificate < 0 else "grid",
        operating_points=report.points,
        certificate=report.certificate,
        worst_excess=report.worst_excess,
        worst_excess_without_region=report.worst_excess_without,
        relative_error=report.error,
        relative_error_without_region=report.error_without,
    )


def _stable(found: Found) -> bool:
    if found.model is None:
        return all(bool(estimate.model.stable) for estimate in found.local)
    return bool(np.all(found.model.stable(fine_grid(found.model.variables))))


def _poles(found: Found) -> list[PolesAtPoint]:
    return [] if found.model is None else range_poles(found.model)


def _singular_values(parametric: ParametricEstimate) -> list[SingularValues]:
    pairs = zip(parametric.errors, parametric.singular_values, strict=True)
    return [
        SingularValues(operating_point=list(error.operating_point), values=finite(values, "singular values").tolist())
        for error, values in pairs
    ]


def _rows(parametric: ParametricEstimate) -> ChosenRows:
    rows = parametric.rows
    return ChosenRows(
        counts=[int(count) for count in rows.counts],
        indices=[int(index) for index in rows.indices],
        worst_singular_value=rows.worst_singular_value,
    )
