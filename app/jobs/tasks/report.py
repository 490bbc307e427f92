"""Draws all that led to a model as one page."""

from typing import Any

import numpy as np

from app import __version__
from app.conversion.experiments import kept_measurement
from app.jobs.task import TaskContext, TaskResult
from app.report.chain.build import chain_report
from app.report.chain.documents import Chain, Compared, Played
from app.report.page import render
from app.schemas.comparisons import Comparison
from app.schemas.designs import Design
from app.schemas.diagnoses import Diagnosis
from app.schemas.experiments import Experiment
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.schemas.signals import Signals
from identification.signals import Measurement

KIND = "report"


def run(payload: dict[str, Any], context: TaskContext) -> TaskResult:
    """The figures, then the page."""
    context.progress(0.1, "drawing")
    chain = _chain(payload, context)
    report = chain_report(chain, payload["request"]["name"])
    context.progress(0.7, "writing the page")
    page = render(report).encode()
    document = {
        "softwareVersion": __version__,
        "name": report.title[:200],
        "modelId": chain.model.id,
        "versionIds": [one.id for one in chain.versions],
        "experimentIds": [one.id for one in chain.experiments],
        "designIds": [one.id for one in chain.designs],
        "comparisonIds": [one.document.id for one in chain.comparisons],
        "diagnosisIds": [one.id for one in chain.diagnoses],
        "bytes": len(page),
    }
    return TaskResult(document, context.arrays.put({"html": np.frombuffer(page, dtype=np.uint8)}))


def _chain(payload: dict[str, Any], context: TaskContext) -> Chain:
    experiments = tuple(Experiment.model_validate(one["document"]) for one in payload["experiments"])
    kept = {experiment.id: one["arrays"] for experiment, one in zip(experiments, payload["experiments"], strict=True)}

    def measurement(experiment: Experiment) -> Measurement:
        return kept_measurement(experiment, context.arrays.get(kept[experiment.id]))

    return Chain(
        Plant.model_validate(payload["plant"]),
        tuple(map(Model.model_validate, payload["versions"])),
        experiments,
        measurement,
        tuple(map(Design.model_validate, payload["designs"])),
        tuple(
            Compared(Comparison.model_validate(one["document"]), context.arrays.get(one["arrays"]))
            for one in payload["comparisons"]
        ),
        tuple(map(Diagnosis.model_validate, payload["diagnoses"])),
        tuple(
            Played(Signals.model_validate(one["document"]), context.arrays.get(one["arrays"]))
            for one in payload["signals"]
        ),
    )
