"""The simulated stage on the bench: signals in, experiments out."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.demo import task
from app.jobs.task import TaskContext
from app.jobs.tasks.example import experiments
from app.offline.workplace import PLANT_ID, Workplace, stored
from app.report.chain.documents import Played
from app.schemas.experiments import Experiment
from app.services.measured import Measured
from app.virtual_plant.campaign import HELD_OUT, HIGHEST_LINE, measured
from app.virtual_plant.multisine import random_phases
from app.virtual_plant.stage import Stage
from identification.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Laboratory:
    """A stage, and a generator for the phases and the noise."""

    stage: Stage
    generator: np.random.Generator
    place: Workplace

    def first(self) -> list[Measured]:
        """Random-phase multisines of low level at three positions."""
        return self._random(task.FIRST_POSITIONS, task.FIRST_LEVEL, "first: ")

    def held_out(self) -> list[Measured]:
        """At three other positions, for judging only."""
        return self._random(HELD_OUT, task.HELD_OUT_LEVEL, "held out: ")

    def played(self, played: Played) -> list[Measured]:
        """The designed signals at their positions."""
        positions = [one.operating_point[0] for one in played.document.signals]
        forces = np.stack([signal.signal for signal in played.realised()])
        return self._measured(positions, forces, task.PERIODS, "designed: ")

    def _random(self, positions: Sequence[float], level: float, prefix: str) -> list[Measured]:
        levels = np.full(len(positions), level)
        forces = random_phases(levels, task.PERIOD, HIGHEST_LINE, self.generator)
        return self._measured(positions, forces, task.PERIODS, prefix)

    def _measured(self, positions: Sequence[float], forces: FloatArray, periods: int, prefix: str) -> list[Measured]:
        records = measured(self.stage, np.array(positions), forces, periods, self.generator)
        made = experiments(records, PLANT_ID, prefix, TaskContext(self.place.arrays))
        documents = (stored(one.document, f"{prefix}{i}", jobId=None) for i, one in enumerate(made))
        return [
            (Experiment.model_validate(document), one.arrays or "")
            for document, one in zip(documents, made, strict=True)
        ]
