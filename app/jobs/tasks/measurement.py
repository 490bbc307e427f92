"""Plays designed signals on a simulated plant."""

from typing import Any

import numpy as np

from app import __version__
from app.jobs.task import TaskContext, TaskResult
from app.jobs.tasks.example import experiments
from app.schemas.examples import Example, MeasurementRequest
from app.schemas.signals import Signals
from app.virtual_plant.campaign import measured
from app.virtual_plant.hidden import EFFECTS, Hidden
from app.virtual_plant.stage import Stage

KIND = "measurement"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """An experiment for every signal, with noise from the seed."""
    request = MeasurementRequest.model_validate(payload["request"])
    example = Example.model_validate(payload["example"])
    signals = Signals.model_validate(payload["signals"])
    arrays = context.arrays.get(payload["arrays"])
    hidden = Hidden() if example.hidden is None else EFFECTS[example.hidden.kind]
    stage = Stage(hidden, example.noise_standard_deviation)
    generator = np.random.default_rng(request.seed)
    made = []
    for i, one in enumerate(signals.signals):
        context.progress(i / len(signals.signals), f"signal {i + 1} of {len(signals.signals)}")
        force, position = arrays[f"period{one.index}"][None], np.array(one.operating_point)
        records = measured(stage, position, force, one.periods, generator, one.sample_time_seconds)
        made += experiments(records, example.plant_id, "designed: ", context, signals.design_id)
    document = {
        "softwareVersion": __version__,
        "exampleId": example.id,
        "signalsId": signals.id,
        "designId": signals.design_id,
        "experimentIds": [experiment.identifier for experiment in made],
        "seed": request.seed,
    }
    return TaskResult(document, beside=tuple(made))
