"""Looks for the physical effect that a model lacks."""

from typing import Any

from app import __version__
from app.conversion.channels import channels_of
from app.conversion.deciding import deciding_design
from app.conversion.diagnoses import findings
from app.conversion.effects import chosen_effects, extended_model
from app.conversion.experiments import kept_batches
from app.conversion.extremes import within_doubles
from app.conversion.fields import field_named
from app.jobs.task import TaskContext, TaskResult
from app.schemas.diagnoses import DiagnosisRequest
from app.schemas.experiments import Experiment
from app.schemas.models import Model
from app.schemas.plants import Plant
from identification.diagnosis.diagnose import diagnose

KIND = "diagnosis"
FIELDS = {"effects": "/modelId", "model": "/modelId"}
KEPT = ("name", "description", "comparisonId", "amplitudeDegree", "meanValue", "seed")


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """Fit, score tests of all effects, refit of the short list."""
    request = DiagnosisRequest.model_validate(payload["request"])
    experiments = [Experiment.model_validate(given["document"]) for given in payload["experiments"]]
    plant = Plant.model_validate(payload["plant"])
    model, channels = extended_model(Model.model_validate(payload["model"]), plant), channels_of(plant)
    with field_named(FIELDS, payload["pointer"]), within_doubles():
        context.progress(0.1, "the spectra of the experiments")
        batches = kept_batches(payload["experiments"], context.arrays, request.mean_value, channels)
        context.progress(0.3, "what each effect would change")
        effects = chosen_effects(request.effects, request.domain)
        found = diagnose(model, batches, effects, request.amplitude_degree, request.seed, request.material)
        document = {**findings(found, experiments), "material": request.material}
        decisive = deciding_design(found, experiments, payload["plant"]["id"], payload["model"]["id"])
        document["decidingDesign"] = None if decisive is None else decisive.as_json()
    kept = {name: payload["request"][name] for name in KEPT}
    traced = {"modelId": payload["model"]["id"], "experimentIds": [one.id for one in experiments]}
    return TaskResult({"softwareVersion": __version__, **kept, **traced, **document})
