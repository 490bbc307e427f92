"""Makes a simulated plant that hides something, and measures it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from app import __version__
from app.files.measurement import measurement_arrays
from app.jobs.outcomes import Made
from app.jobs.task import TaskContext, TaskResult
from app.jobs.tasks import experiment
from app.schemas.examples import ExampleRequest, HiddenEffectDocument
from app.schemas.plants import PlantRequest
from app.services.plants import described
from app.store.identifiers import new_identifier
from app.virtual_plant.campaign import PLANT, first_campaign
from app.virtual_plant.hidden import EFFECTS, Hidden
from app.virtual_plant.stage import Stage
from identification.signals import TimeRecord

KIND = "example"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The plant, its experiments, and what it hides."""
    request = ExampleRequest.model_validate(payload["request"])
    generator = np.random.default_rng(request.seed)
    hidden = _hidden(request.hidden_effect, generator)
    stage = Stage(hidden)
    context.progress(0.1, "measuring the simulated plant")
    campaign = first_campaign(stage, generator)
    plant_id = new_identifier()
    plant = PlantRequest.model_validate({**PLANT, "name": request.name or PLANT["name"]})
    context.progress(0.6, "looking at the measurements")
    fitted = experiments(campaign.fitted, plant_id, "", context)
    held_out = experiments(campaign.held_out, plant_id, "held out: ", context)
    document = {
        "softwareVersion": __version__,
        "plantId": plant_id,
        "experimentIds": [one.identifier for one in fitted],
        "heldOutExperimentIds": [one.identifier for one in held_out],
        "noiseStandardDeviation": stage.noise,
        "seed": request.seed,
        "hidden": _revealed(hidden),
    }
    beside = (Made("plants", plant_id, None, described(plant)), *fitted, *held_out)
    return TaskResult(document, beside=beside)


def experiments(
    records: Sequence[TimeRecord], plant_id: str, prefix: str, context: TaskContext, design_id: str | None = None
) -> list[Made]:
    """The records as experiments of the plant, looked at like any others."""
    return [_experiment(record, plant_id, prefix, context, design_id) for record in records]


def _hidden(choice: str, generator: np.random.Generator) -> Hidden:
    if choice == "random":
        choice = str(generator.choice(list(EFFECTS)))
    return EFFECTS.get(choice, Hidden())


def _revealed(hidden: Hidden) -> dict[str, Any] | None:
    if hidden.kind not in EFFECTS:
        return None
    return HiddenEffectDocument(kind=hidden.kind, amplitude=hidden.amplitude, unit=hidden.unit).as_json()


def _experiment(record: TimeRecord, plant_id: str, prefix: str, context: TaskContext, design_id: str | None) -> Made:
    level = float(np.sqrt(np.mean(record.input**2)))
    stated = {
        "plantId": plant_id,
        "name": f"{prefix}{record.operating_point[0]:g} m, {level:.3g} N",
        "description": "",
        "operatingPoint": list(record.operating_point),
        "designId": design_id,
        "kind": "timeRecord",
        "sampleTimeSeconds": record.sample_time,
        "periodSamples": record.period,
    }
    arrays = context.arrays.put(measurement_arrays(record))
    given = {"source": "json", "fileName": None, "stated": stated, "channels": [1, 1], "arrays": arrays}
    found = experiment.run(given, TaskContext(context.arrays))
    return Made("experiments", new_identifier(), plant_id, found.document, found.arrays)
