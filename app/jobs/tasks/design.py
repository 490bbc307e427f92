"""Designs the experiments of least energy."""

from dataclasses import replace
from typing import Any

import numpy as np
from pydantic.alias_generators import to_camel

from app import __version__
from app.arrays import finite_or_none, finite_parts
from app.conversion.channels import channels_of
from app.conversion.designs import (
    candidate_points,
    decision_document,
    energy_caps,
    plant_limits,
    prior_information,
    promise,
    searched_model,
)
from app.conversion.effects import extended_model
from app.conversion.experiments import kept_batches
from app.conversion.extensions import joint_names
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.conversion.models import outcome_document
from app.conversion.spectra import curve, spectrum_document
from app.jobs.task import TaskContext, TaskResult
from app.schemas.designs import BindingDocument, Box, DesignedExperimentDocument, DesignRequest
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import Plant
from identification.comparison.batch import Batch
from identification.errors import MisuseError
from identification.models.model import Model, require_matching
from oed.column_generation import Progress
from oed.design import Binding, Design, design
from oed.problem import DecisionTarget, DesignProblem, Target
from oed.robust import Kept, Promise, promised

KIND = "design"
FIELDS = {
    "points": "/operatingPoints",
    "operating_points": "/operatingPoints",
    "excluded_points": "/excludedPoints",
    "energy_caps": "/energyCaps",
    "caps": "/energyCaps",
    "prior_information": "/usePriorInformation",
    "use_prior_information": "/usePriorInformation",
    "band": "/band",
    "limits": "/limits",
    "samples": "/samples",
    "sample_time": "/sampleTimeSeconds",
    "targets": "/targets",
    "model": "/modelId",
    "degree": "/spectrumFamily/degree",
    "levels": "/spectrumFamily/levels",
    "promise": "/promise",
    "family": "/spectrumFamily",
    **dict.fromkeys(("effect", "effects", "against", "amplitude"), "/targets"),
}


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """State the problem, solve it, describe the answer."""
    context.progress(0.02, "stating the problem")
    plant = Plant.model_validate(payload["plant"])
    request = DesignRequest.model_validate(payload["request"])
    document = ModelDocument.model_validate(payload["model"])
    model = extended_model(document, plant)
    if request.noise_variance is not None:
        model = replace(model, noise_variance=request.noise_variance)
    given = payload["experiments"]
    with field_named({}, "/priorExperimentIds"), within_doubles():
        experiments = kept_batches(given, context.arrays, True, channels_of(plant)) if given else ()
        require_matching(model, experiments)
    with field_named(FIELDS, "/operatingPoints"), within_doubles():
        problem = stated_problem(request, model, document.covariance is not None, experiments)
        found, kept = _found(request, problem, _reporter(context, request.tolerance))
    return TaskResult({**_document(payload, problem, found), "promise": None if kept is None else promise(kept)})


def _found(request: DesignRequest, problem: DesignProblem, report: Progress) -> tuple[Design, Kept | None]:
    if request.promise is None:
        return design(problem, progress=report), None
    asked = request.promise
    return promised(problem, Promise(asked.probability, asked.noise_deviation, seed=asked.seed), report)


def stated_problem(
    request: DesignRequest, model: Model, covariance_known: bool, experiments: tuple[Batch, ...] = ()
) -> DesignProblem:
    """The problem of a request; raises MisuseError."""
    known = prior_information(model, covariance_known) if request.use_prior_information else None
    model = searched_model(request, model)
    points = candidate_points(request, model.dependence)
    band = request.band
    return DesignProblem(
        model=model,
        points=points,
        targets=_fitting_targets(request, model),
        family=request.spectrum_family.build(),
        samples=request.samples,
        caps=energy_caps(request, points, model.dependence),
        prior_information=known,
        prior_experiments=experiments,
        band=None if band is None else (band.minimum_rad_per_second, band.maximum_rad_per_second),
        sample_time=model.structure.sample_time or request.sample_time_seconds,
        tolerance=request.tolerance,
        box=isinstance(request.operating_points, Box),
        plant_limits=plant_limits(request, model, points),
    )


def _fitting_targets(request: DesignRequest, model: Model) -> tuple[Target, ...]:
    targets = []
    for i, given in enumerate(request.targets):
        target: Target = given.build()
        try:
            with within_doubles():
                if not isinstance(target, DecisionTarget):
                    target.matrices(model)
        except MisuseError as error:
            raise MisuseError(str(error), f"/targets/{i}/{to_camel(error.field or '')}".rstrip("/")) from error
        targets.append(target)
    return tuple(targets)


def _reporter(context: TaskContext, tolerance: float) -> Progress:
    def report(iteration: int, gap: float) -> None:
        reached = np.log(max(min(gap, 1.0), tolerance)) / np.log(tolerance) if np.isfinite(gap) else 0.0
        context.progress(0.05 + 0.9 * float(reached), f"iteration {iteration}, gap {gap:.1e}")

    return report


def _document(payload: dict[str, Any], problem: DesignProblem, found: Design) -> dict[str, Any]:
    experiments = [
        DesignedExperimentDocument(
            operating_point=list(experiment.operating_point),
            energy=experiment.energy,
            spectrum=spectrum_document(experiment.spectrum),  # type: ignore[arg-type]
            curve=curve(experiment.spectrum, problem.step),  # type: ignore[arg-type]
        )
        for experiment in found.experiments
    ]
    return {
        "softwareVersion": __version__,
        "request": payload["request"],
        "modelId": payload["model"]["id"],
        "outcome": outcome_document(found.outcome).as_json(),
        "sampleTimeSeconds": problem.step,
        "experiments": [experiment.as_json() for experiment in experiments],
        "totalEnergy": finite_or_none(found.total_energy),
        "leastEnergy": finite_or_none(found.least_energy),
        "lowerBound": finite_or_none(found.lower_bound),
        "gap": finite_or_none(found.gap),
        "samples": found.samples,
        "requiredSamples": finite_or_none(found.required_samples),
        "parameterNames": _names(problem.model),
        "expectedCovariance": finite_parts(found.expected_covariance),
        "expectedStandardDeviations": finite_parts(np.sqrt(np.diagonal(found.expected_covariance))),
        "binding": [_binding(problem, binding).as_json() for binding in found.binding],
        "decisions": [decision_document(number, one).as_json() for number, one in found.decisions],
    }


def _names(model: Model) -> list[str]:
    """θ_G, the parameters of the effects, θ_H."""
    return [*joint_names(model), *model.parameter_names[model.plant_size :]]


def _binding(problem: DesignProblem, binding: Binding) -> BindingDocument:
    is_target = binding.what == "target"
    return BindingDocument(
        what=binding.what,
        target_index=binding.index if is_target else None,
        limit_index=binding.index if binding.what == "limit" else None,
        operating_point=None if binding.point is None else problem.points[binding.point].tolist(),
        multiplier=finite_or_none(binding.multiplier),
    )
