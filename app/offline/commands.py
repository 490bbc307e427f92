"""The commands `identify` and `design`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from app.conversion.plants import is_state_space
from app.offline import results
from app.offline.documents import checked, load, section
from app.offline.experiments import experiments_of
from app.offline.explained import explained
from app.offline.loop import Loop
from app.offline.subjects import model_in, plant_in
from app.offline.workplace import DESIGN_ID, MODEL_ID, PLANT_ID, Workplace, stored, workplace
from app.schemas.designs import Design, DesignRequest
from app.schemas.experiments import Experiment
from app.schemas.models import Model, ModelRequest
from app.schemas.plants import Plant
from app.schemas.signals import Signals, SignalsRequest
from app.schemas.state_space import StateSpaceModelRequest
from app.services import designs, models, signals, state_space_models

if TYPE_CHECKING:
    from app.report.chain.documents import Played

INFEASIBLE = 3
DESIGNED = (
    "Where to measure and with which signals, so that the accuracy asked for is reached with the least input energy;"
    " and the model that this was computed from."
)


@explained
def identify(file: Path, output: Path, report: Path | None = None) -> None:
    """Identify a model from the experiments in a request file."""
    content = load(file)
    plant = plant_in(content)
    with workplace() as place:
        experiments = experiments_of(place, plant, section(content, "experiments"), file.parent)
        names = [experiment.id for experiment, _ in experiments]
        asked = {"plantId": PLANT_ID, "experimentIds": names, **section(content, "model")}
        by_name = {experiment.id: (experiment, arrays) for experiment, arrays in experiments}
        kind: type[StateSpaceModelRequest | ModelRequest]
        kind = StateSpaceModelRequest if is_state_space(plant.structure) else ModelRequest
        request = checked(kind, asked, "/model")
        chosen = [by_name[name] for name in request.experiment_ids if name in by_name]
        found = place.run(*_identification(plant, request, chosen))
        model = Model.model_validate(stored(found.document, MODEL_ID, plantId=PLANT_ID, jobId=None))
        results.write_model(output, model, [experiment for experiment, _ in chosen])
        if report is not None:
            results.write_report(report, Loop(place, plant, tuple(chosen)).chain([model], [], []))


@explained
def design(file: Path, output: Path, report: Path | None = None) -> None:
    """Design the experiments of a request file, and make their signals when it asks for them; 3 is "infeasible"."""
    content = load(file)
    plant = plant_in(content)
    model = model_in(content, plant, file.parent)
    asked = {"plantId": PLANT_ID, "modelId": model.id, **section(content, "design")}
    request = checked(DesignRequest, asked, "/design")
    with workplace() as place:
        found = place.run("design", designs.payload(plant, model, request))
        made = Design.model_validate(stored(found.document, DESIGN_ID, plantId=PLANT_ID, jobId=None))
        results.write_design(output, made)
        played: tuple[Played, ...] = ()
        if "signals" in content and made.experiments:
            played = (_signals(place, made, checked(SignalsRequest, content["signals"] or {}, "/signals"), output),)
        if report is not None:
            chain = Loop(place, plant, ()).chain([model], [], [], (made,), played)
            results.write_report(report, chain, f"{plant.name}: the designed experiments", DESIGNED)
    if made.outcome.status == "infeasible":
        raise typer.Exit(INFEASIBLE)


def _identification(
    plant: Plant, request: StateSpaceModelRequest | ModelRequest, experiments: list[tuple[Experiment, str]]
) -> tuple[str, dict[str, Any]]:
    """The task that identifies the model asked for, and what it gets."""
    if isinstance(request, StateSpaceModelRequest):
        return state_space_models.TASK, state_space_models.payload(plant, request, experiments)
    return "identification", models.payload(plant, request, experiments)


def _signals(place: Workplace, design: Design, request: SignalsRequest, output: Path) -> "Played":
    from app.report.chain.documents import Played

    found = place.run("signals", signals.payload(design, request))
    document = stored(found.document, "signals", plantId=PLANT_ID, jobId=None)
    played = Played(Signals.model_validate(document), place.arrays.get(found.arrays or ""))
    results.write_signals(output, played.document, played.arrays)
    return played
