"""Steady states at operating points held still: whether a request can be simulated, and what the job gets."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.container import Container
from app.conversion.experiments import logged_values, quantities_by_name
from app.conversion.misuse import pointing
from app.conversion.plants import channels, is_state_space, plant_dependence
from app.errors import UnprocessableError
from app.schemas.models import Model
from app.schemas.plants import DiscreteStateSpaceStructure, DiscreteTimeStructure, Plant
from app.schemas.signals import SignalDocument
from app.schemas.simulations import (
    PeriodicExcitation,
    PeriodicExperimentExcitation,
    PeriodicSignalExcitation,
    SimulationRequest,
    Steady,
)
from app.services.documents import named, of_plant
from app.services.experiments import experiment_of
from app.services.fitting import SAMPLE_TIME_TOLERANCE
from app.services.measured import LEAST_PERIODS, periodic
from app.services.signals import signals_of

LONGEST_PERIOD = 200_000
MOST_SAMPLES = 1_000_000
POINTS = "/excitation/operatingPoints"


def steady_payload(container: Container, plant: Plant, model: Model, request: SimulationRequest) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError where the excitation does not fit the model."""
    asked = request.excitation
    assert isinstance(asked, Steady), "along p(t) there is no steady state"
    _check_kind(plant, model)
    played = _played(container, plant, asked)
    _check_sampling(model, played)
    _check_points(plant, played)
    logged = {**played["loggedQuantities"], **quantities_by_name(asked.logged_quantities)}
    _check_logged(model, logged)
    return {
        **played,
        "plant": plant.as_json(),
        "model": model.as_json(),
        "loggedQuantities": logged,
        "stated": stated_fields(request, played["sampleTimeSeconds"]),
    }


def stated_fields(request: SimulationRequest, sample_time: float) -> dict[str, Any]:
    """What the document of a simulation takes over from its request."""
    return {
        "name": request.name,
        "description": request.description,
        "experimentId": getattr(request.excitation, "experiment_id", None),
        "signalsId": getattr(request.excitation, "signals_id", None),
        "sampleTimeSeconds": sample_time,
    }


def designed_signal(
    container: Container, plant: Plant, signals_id: str, index: int
) -> tuple[NDArray[Any], SignalDocument]:
    """One period of a signal of the plant, and its document."""
    pointer = "/excitation/signalsId"
    row = of_plant(named(container.resources, "signals", signals_id, pointer), plant.id, pointer)
    made = signals_of(row).signals
    if index >= len(made):
        raise UnprocessableError.at("/excitation/index", f"there are {len(made)} signals, numbered from 0")
    return container.arrays.get(row.arrays or "")[f"period{index}"], made[index]


def _played(container: Container, plant: Plant, asked: Steady) -> dict[str, Any]:
    """The input, where it is played, and where each stands in the request."""
    if isinstance(asked, PeriodicExperimentExcitation):
        return _of_experiment(container, plant, asked)
    if isinstance(asked, PeriodicSignalExcitation):
        return _of_signal(container, plant, asked)
    assert isinstance(asked, PeriodicExcitation)
    return {
        "arrays": container.arrays.put({"input": np.array(asked.input)}),
        "experiment": None,
        "samples": len(asked.input),
        "sampleTimeSeconds": asked.sample_time_seconds,
        "operatingPoints": asked.operating_points,
        "loggedQuantities": {},
        "pointers": _pointers("/excitation/input", "/excitation/sampleTimeSeconds", POINTS),
    }


def _of_signal(container: Container, plant: Plant, asked: PeriodicSignalExcitation) -> dict[str, Any]:
    period, signal = designed_signal(container, plant, asked.signals_id, asked.index)
    pointer = "/excitation/signalsId"
    own = asked.operating_points is None
    return {
        "arrays": container.arrays.put({"input": period}),
        "experiment": None,
        "samples": len(period),
        "sampleTimeSeconds": signal.sample_time_seconds,
        "operatingPoints": asked.operating_points or [signal.operating_point],
        "loggedQuantities": {},
        "pointers": _pointers(pointer, pointer, pointer if own else POINTS),
    }


def _of_experiment(container: Container, plant: Plant, asked: PeriodicExperimentExcitation) -> dict[str, Any]:
    pointer = "/excitation/experimentId"
    row = of_plant(named(container.resources, "experiments", asked.experiment_id, pointer), plant.id, pointer)
    experiment = experiment_of(row)
    if not periodic(experiment):
        raise UnprocessableError.at(
            pointer,
            f"this is no time record of at least {LEAST_PERIODS} periods at one operating point; name one, or state one"
            " period of the input",
        )
    return {
        "arrays": row.arrays or "",
        "experiment": experiment.as_json(),
        "samples": experiment.understood.period_samples,
        "sampleTimeSeconds": experiment.sample_time_seconds,
        "operatingPoints": [experiment.held_at],
        "loggedQuantities": logged_values(experiment),
        "pointers": _pointers(pointer, pointer, pointer),
    }


def _pointers(input: str, sample_time: str, points: str) -> dict[str, str]:
    logged = "/excitation/loggedQuantities"
    return {"input": input, "sample_time": sample_time, "operating_points": points, "logged": logged}


def _check_kind(plant: Plant, model: Model) -> None:
    if is_state_space(model.structure) and (model.varying is None or channels(plant) != (1, 1)):
        raise UnprocessableError.at(
            "/modelId",
            "the steady state is that of rational models, and of models from varying scheduling with one input and one"
            " output; play this one along p(t), or take its frequency response",
            "path",
        )


def _check_sampling(model: Model, played: dict[str, Any]) -> None:
    if not isinstance(model.structure, DiscreteTimeStructure | DiscreteStateSpaceStructure):
        return
    own, given = model.structure.sample_time_seconds, played["sampleTimeSeconds"]
    if abs(given / own - 1) > SAMPLE_TIME_TOLERANCE:
        raise UnprocessableError.at(
            played["pointers"]["sample_time"],
            f"the input is sampled every {given:g} s, the model every {own:g} s; play one of the same sample time",
        )


def _check_points(plant: Plant, played: dict[str, Any]) -> None:
    points, pointers = played["operatingPoints"], played["pointers"]
    dependence = plant_dependence(plant)
    for i, point in enumerate(points):
        pointer = pointers["operating_points"]
        with pointing({}, f"{pointer}/{i}" if pointer == POINTS else pointer):
            dependence.points([point])
    samples = played["samples"]
    if samples > LONGEST_PERIOD or samples * len(points) > MOST_SAMPLES:
        raise UnprocessableError.at(
            pointers["input"],
            f"{samples} samples at {len(points)} operating points are too many; give at most {LONGEST_PERIOD} a period"
            f" and {MOST_SAMPLES} together",
        )


def _check_logged(model: Model, logged: dict[str, float]) -> None:
    missing = sorted({one.quantity for one in model.effects if one.quantity is not None} - set(logged))
    if missing:
        raise UnprocessableError.at(
            "/excitation/loggedQuantities",
            f"the model depends on {', '.join(missing)}; state its value here, in this unit",
        )
