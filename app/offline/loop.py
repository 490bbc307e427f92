"""Compare, diagnose and extend without a server: the tasks of the service on experiments in hand."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.conversion.experiments import kept_measurement
from app.errors import UnprocessableError
from app.offline.documents import checked
from app.offline.experiments import experiments_of
from app.offline.workplace import PLANT_ID, Workplace, stored
from app.schemas.comparisons import Comparison, ComparisonRequest
from app.schemas.designs import Design
from app.schemas.diagnoses import Diagnosis, DiagnosisRequest
from app.schemas.extensions import ExtensionRequest
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.services import comparisons, diagnoses, extensions
from app.services.measured import Measured

if TYPE_CHECKING:
    from app.report.chain.documents import Chain, Compared, Played

HELD_OUT = "heldOut"


@dataclass(frozen=True, eq=False)
class Loop:
    """A plant with experiments, some of them held out; each method runs one task."""

    place: Workplace
    plant: Plant
    experiments: tuple[Measured, ...]
    held_out: frozenset[str] = frozenset()

    @property
    def fitted(self) -> list[Measured]:
        """The experiments that models are fitted to."""
        return [one for one in self.experiments if one[0].id not in self.held_out]

    @property
    def others(self) -> list[Measured]:
        """The experiments that are held out."""
        return [one for one in self.experiments if one[0].id in self.held_out]

    def compare(self, model: Model, asked: dict[str, Any] | None = None) -> "Compared":
        """Hold a model against all experiments."""
        from app.report.chain.documents import Compared

        body = {"modelId": model.id, "experimentIds": _names(self.experiments), **(asked or {})}
        request = checked(ComparisonRequest, body, "/compare")
        task = comparisons.payload(self.plant, model, request, list(self.experiments), set(_names(self.fitted)))
        found = self.place.run("comparison", task)
        document = stored(found.document, f"comparison-{model.id}", plantId=PLANT_ID, jobId=None)
        return Compared(Comparison.model_validate(document), self.place.arrays.get(found.arrays or ""))

    def diagnose(self, model: Model, asked: dict[str, Any] | None = None) -> Diagnosis:
        """What a model lacks, by the experiments that it is fitted to."""
        body = {"modelId": model.id, "experimentIds": _names(self.fitted), **(asked or {})}
        request = checked(DiagnosisRequest, body, "/diagnose")
        found = self.place.run("diagnosis", diagnoses.payload(self.plant, model, request, self.fitted))
        document = stored(found.document, f"diagnosis-{model.id}", plantId=PLANT_ID, jobId=None)
        return Diagnosis.model_validate(document)

    def extend(self, model: Model, asked: dict[str, Any]) -> Model:
        """A new version of a model with one effect more."""
        names = {"experimentIds": _names(self.fitted), "heldOutExperimentIds": _names(self.others)}
        request = checked(ExtensionRequest, {**names, **asked}, "/extend")
        task = extensions.payload(self.plant, model, request, self.fitted, self.others, set(names["experimentIds"]))
        found = self.place.run("extension", task)
        document = stored(found.document, f"version{len(model.effects) + 2}", plantId=PLANT_ID, jobId=None)
        return Model.model_validate(document)

    def chain(
        self,
        versions: list[Model],
        compared: list["Compared"],
        diagnosed: list[Diagnosis],
        designed: tuple[Design, ...] = (),
        played: tuple["Played", ...] = (),
    ) -> "Chain":
        """All of it for a report."""
        from app.report.chain.documents import Chain

        measured = {one.id: kept_measurement(one, self.place.arrays.get(arrays)) for one, arrays in self.experiments}
        return Chain(
            self.plant,
            tuple(versions),
            tuple(experiment for experiment, _ in self.experiments),
            lambda one: measured[one.id],
            designed,
            tuple(compared),
            tuple(diagnosed),
            played,
        )


def loop_of(place: Workplace, plant: Plant, given: Any, folder: Path) -> Loop:
    """The experiments of a request file; those marked `heldOut: true` are not fitted."""
    entries = given if isinstance(given, list) else []
    for i, one in enumerate(entries):
        if isinstance(one, dict) and not isinstance(one.get(HELD_OUT, False), bool):
            raise UnprocessableError.at(f"/experiments/{i}/{HELD_OUT}", "must be true or false")
    marked = [isinstance(one, dict) and one.get(HELD_OUT, False) for one in entries]
    plain = [_without_mark(one) if isinstance(one, dict) else one for one in entries] if entries else given
    measured = experiments_of(place, plant, plain, folder)
    held_out = frozenset(one.id for (one, _), mark in zip(measured, marked, strict=True) if mark)
    if len(held_out) == len(measured):
        raise UnprocessableError.at("/experiments", "all experiments are held out; leave some to fit the model to")
    return Loop(place, plant, tuple(measured), held_out)


def _without_mark(entry: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in entry.items() if name != HELD_OUT}


def _names(experiments: "list[Measured] | tuple[Measured, ...]") -> list[str]:
    return [experiment.id for experiment, _ in experiments]
