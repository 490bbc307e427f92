"""What a report of the whole chain is made from: the documents of the service and the arrays they name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.conversion.effects import extended_model
from app.report.axes import Axes
from app.report.figures.misfit_map import MapRow
from app.report.figures.staircase import Step
from app.schemas.comparisons import Comparison
from app.schemas.designs import Design
from app.schemas.diagnoses import Diagnosis
from app.schemas.experiments import Experiment
from app.schemas.models import ErrorsDocument
from app.schemas.models import Model as ModelDocument
from app.schemas.plants import ContinuousTimeStructure, DiscreteTimeStructure, Plant
from app.schemas.signals import SignalDocument, Signals
from identification.models.model import Model
from identification.scheduling import SchedulingVariable
from identification.signals import Measurement
from oed.realisation.realised_signal import RealisedSignal

Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Compared:
    """A comparison with the arrays of its map."""

    document: Comparison
    arrays: Arrays


@dataclass(frozen=True, eq=False)
class Played:
    """The signals of a design with one period of each."""

    document: Signals
    arrays: Arrays

    def realised(self) -> list[RealisedSignal]:
        """The signals as they are played."""
        return [self._realised(one) for one in self.document.signals]

    def _realised(self, one: SignalDocument) -> RealisedSignal:
        period = np.asarray(self.arrays[f"period{one.index}"])
        requested, achieved = np.zeros(len(period) // 2 + 1), np.zeros(len(period) // 2 + 1)
        lines = np.rint(np.array(one.frequencies_rad_per_second) * len(period) * one.sample_time_seconds / (2 * np.pi))
        requested[lines.astype(int)], achieved[lines.astype(int)] = one.requested_energies, one.achieved_energies
        return RealisedSignal(
            period,
            one.periods,
            one.sample_time_seconds,
            self.document.request.method,
            one.crest_factor,
            one.crest_factor_between_samples,
            requested,
            achieved,
            one.amplitude_limit,
            one.amplitude_limit_binds,
            one.needed_samples,
        )


@dataclass(frozen=True, eq=False)
class Chain:
    """Versions of a model, oldest first, with what they were made from and held against.

    `measurement` fetches what was measured; `designs` in the order in which they were made.
    """

    plant: Plant
    versions: tuple[ModelDocument, ...]
    experiments: tuple[Experiment, ...] = ()
    measurement: Callable[[Experiment], Measurement] | None = None
    designs: tuple[Design, ...] = ()
    comparisons: tuple[Compared, ...] = ()
    diagnoses: tuple[Diagnosis, ...] = ()
    signals: tuple[Played, ...] = ()

    @property
    def model(self) -> ModelDocument:
        """The latest version."""
        return self.versions[-1]

    @cached_property
    def axes(self) -> Axes:
        """How the quantities of the plant are called."""
        variables = tuple(
            SchedulingVariable(v.name, v.unit, v.minimum, v.maximum) for v in self.plant.scheduling_variables
        )
        first, last = self.plant.input, self.plant.output
        inputs = ("input", "") if first is None else (first.name, first.unit)
        outputs = ("output", "") if last is None else (last.name, last.unit)
        return Axes(variables, *inputs, *outputs)

    @cached_property
    def labels(self) -> dict[str, str]:
        """How each experiment is called: its name, or its operating point."""
        return {one.id: one.name or self.place(one) for one in self.experiments}

    def place(self, one: Experiment) -> str:
        """The operating point of an experiment in words."""
        return "varying" if one.operating_point is None else self.axes.point(tuple(one.operating_point))

    def rational(self, model: ModelDocument) -> Model | None:
        """The model with its effects; None for other structures than rational ones."""
        if not isinstance(model.structure, DiscreteTimeStructure | ContinuousTimeStructure):
            return None
        return extended_model(model, self.plant)

    def version_name(self, model: ModelDocument) -> str:
        """What a version has that the one before it had not."""
        if model.effects and model.extension is not None:
            return f"with {model.effects[-1].title}"
        return model.name or {"stated": "stated", "identified": "identified"}.get(model.origin, model.origin)

    def map_rows(self, compared: Compared) -> list[MapRow]:
        """The rows of a comparison's map, by operating point; records along varying scheduling have none."""
        found = []
        for place, one in enumerate(compared.document.experiments):
            point = one.operating_point
            if point is None:
                continue
            label = self.labels.get(one.experiment_id, self.axes.point(tuple(point)))
            own = (compared.arrays[f"{name}{place}"] for name in ("frequenciesRadPerSecond", "residual", "lineClass"))
            found.append((point, MapRow(label, one.data == "heldOut", *map(np.asarray, own))))
        return [row for _, row in sorted(found, key=lambda pair: pair[0])]

    def steps(self) -> list[Step]:
        """The staircase of errors, from the reports of the extensions."""
        found: list[Step] = []
        for model in self.versions:
            if model.extension is None:
                continue
            if not found:
                found.append(_step("without effects", model.extension.before))
            found.append(_step(self.version_name(model), model.extension.after))
        return found


def _step(name: str, errors: ErrorsDocument) -> Step:
    return Step(name, errors.fitted, errors.held_out, errors.lack_of_fit.p_value)
