"""Identifies a state-space model from a record along varying scheduling."""

from typing import Any

from pydantic.alias_generators import to_camel

from app import __version__
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.plants import product_basis
from app.conversion.varying_models import (
    eigenvalue_documents,
    model_parts,
    requested_basis,
    requested_structure,
    state_space_part,
    structure_document,
)
from app.conversion.varying_records import kept_record
from app.conversion.varying_results import fit_document, noise_document, steady_document, used_periods
from app.jobs.task import TaskContext, TaskResult
from app.schemas.experiments import Experiment
from app.schemas.plants import Plant
from app.schemas.plug_ins import PlugInDocument
from app.schemas.varying import VaryingModelRequest, VaryingResult
from identification.errors import NotIdentifiableError
from identification.estimates import Estimate
from identification.scheduling import ProductBasis
from identification.varying.progress import within
from identification.varying.records import VaryingRecord

KIND = "varying_identification"
OF_DATA = ("input", "output", "scheduling", "period", "sample_time", "record")


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The estimator, then the refinement, then what the model is worth on each record."""
    plant = Plant.model_validate(payload["plant"])
    request = VaryingModelRequest.model_validate(payload["request"])
    fitted = Experiment.model_validate(payload["experiment"]["document"])
    record = kept_record(fitted, plant, context.arrays.get(payload["experiment"]["arrays"]))
    order = requested_structure(plant, request).order
    with within_doubles():
        basis = product_basis(requested_basis(plant, request))
        first = _estimated(request.estimator, "/estimator", record, order, None, basis, context)
        last = first
        if request.refinement is not None:
            order = first.model.structure.order
            last = _estimated(request.refinement, "/refinement", record, order, first, basis, context)
        context.progress(0.9, "judging the model")
        return TaskResult(_document(plant, request, record, (first, last), payload, context))


def _estimated(
    asked: PlugInDocument,
    pointer: str,
    record: VaryingRecord,
    order: int | None,
    start: Estimate | None,
    basis: ProductBasis,
    context: TaskContext,
) -> Estimate:
    """What an estimator finds; raises NotIdentifiableError when the record cannot determine the parameters."""
    options = {name: f"{pointer}/{to_camel(name)}" for name in type(asked).model_fields}
    fields = {
        **options,
        **dict.fromkeys(OF_DATA, "/experimentId"),
        "order": "/structure",
        "start": pointer,
        "basis": "/basis",
    }
    ends = (0.05, 0.5) if start is None else (0.5, 0.9)
    begun: dict[str, Any] = {"basis": basis} | ({} if start is None else {"start": start.model})
    with field_named(fields, "/experimentId"):
        found: Estimate = asked.build().estimate(record, order, **begun, progress=within(context.progress, *ends))
        if found.outcome.status == "not_identifiable":
            raise NotIdentifiableError(
                f"this record does not determine a model of order {found.model.structure.order}:"
                f" {found.outcome.advice}",
                "record",
            )
    return found


def _document(
    plant: Plant,
    request: VaryingModelRequest,
    record: VaryingRecord,
    estimates: tuple[Estimate, Estimate],
    payload: dict[str, Any],
    context: TaskContext,
) -> dict[str, Any]:
    estimate = estimates[1]
    asked = request.as_json()
    return {
        **{name: asked[name] for name in ("name", "description")},
        "softwareVersion": __version__,
        "origin": "identified",
        "structure": structure_document(requested_structure(plant, request), estimate.model),
        "basis": requested_basis(plant, request).as_json(),
        "coefficientBases": [],
        **model_parts(estimate.model, estimate.outcome, estimate.tests),
        "localModels": [],
        **dict.fromkeys(("localEstimator", "lpvEstimator", "spectralEstimator", "parentId", "seed")),
        "experimentIds": [request.experiment_id],
        "designId": payload["experiment"]["document"]["designId"],
        "stateSpace": state_space_part(estimate.model),
        "varying": _result(plant, request, record, estimates, payload, context).as_json(),
    }


def _result(
    plant: Plant,
    request: VaryingModelRequest,
    record: VaryingRecord,
    estimates: tuple[Estimate, Estimate],
    payload: dict[str, Any],
    context: TaskContext,
) -> VaryingResult:
    first, last = estimates
    used = [asked.build() for asked in (request.estimator, request.refinement) if asked is not None]
    steady = used_periods(record, used)
    fits = [fit_document(last.model, record, request.experiment_id, "fitted")]
    for given in payload["heldOut"]:
        other = Experiment.model_validate(given["document"])
        held_out = kept_record(other, plant, context.arrays.get(given["arrays"]))
        fits.append(fit_document(last.model, held_out, other.id, "heldOut"))
    return VaryingResult(
        estimator=request.estimator,
        refinement=request.refinement,
        starting_outcome="" if request.refinement is None else f"{first.outcome.status}: {first.outcome.advice}",
        steady=None if steady is None else steady_document(steady),
        eigenvalues=eigenvalue_documents(last.model),
        noise_spectrum=noise_document(last.model, record, steady),
        fits=fits,
        warnings=[] if first.found is None else list(first.found.warnings),
    )
