"""Simulations: asked for, made in a job, and their samples."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.container import Container
from app.conversion.misuse import pointing
from app.conversion.plants import channels, is_state_space, scheduling_variables
from app.conversion.varying_records import stacked
from app.errors import UnprocessableError
from app.files.stored import Format, arrays_file
from app.jobs.records import JobRecord
from app.schemas.models import Model
from app.schemas.plants import ContinuousTimeStructure, DiscreteStateSpaceStructure, DiscreteTimeStructure, Plant
from app.schemas.simulations import (
    ExperimentExcitation,
    GivenExcitation,
    SignalExcitation,
    Simulation,
    SimulationData,
    SimulationList,
    SimulationRequest,
    Steady,
)
from app.services.documents import fields, items, named, of_plant
from app.services.experiments import experiment_of
from app.services.fitting import check_sample_time
from app.services.jobs import fingerprint
from app.services.models import model_of
from app.services.plants import plant_of
from app.services.steady_simulations import designed_signal, stated_fields, steady_payload
from app.store.resources import Resource, ResourceRepository
from identification.confidence import QUANTILE_95
from identification.varying.records import require_within_range

KIND = "simulations"
MOST_SAMPLES = 1_000_000
INSTEAD = "play a periodic input at operating points instead (kind periodic), or name another model"
Arrays = dict[str, NDArray[Any]]


def submit(container: Container, model_id: str, request: SimulationRequest, key: str | None) -> JobRecord:
    """Start the job that simulates a model."""
    resources = container.resources
    model = model_of(resources.get("models", model_id))
    plant = plant_of(resources.get("plants", model.plant_id))
    steady = isinstance(request.excitation, Steady)
    task = steady_payload(container, plant, model, request) if steady else _payload(container, plant, model, request)
    mark = fingerprint("createSimulation", model_id, request.model_dump(mode="json"))
    return container.ledger.submit("steady_simulation" if steady else "simulation", task, KIND, plant.id, key, mark)


def _payload(container: Container, plant: Plant, model: Model, request: SimulationRequest) -> dict[str, Any]:
    sample_time = _sample_time(model)
    arrays, pointers = _excitation(container, plant, sample_time, request)
    with pointing(pointers, pointers["scheduling"]):
        _check(plant, arrays, pointers)
        require_within_range(scheduling_variables(plant), arrays["scheduling"])
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "arrays": container.arrays.put(arrays),
        "pointers": pointers,
        "stated": stated_fields(request, sample_time),
    }


def _sample_time(model: Model) -> float:
    if model.effects:
        kinds = ", ".join(one.kind for one in model.effects)
        raise UnprocessableError.at("/modelId", f"{kinds} cannot be followed along p(t); {INSTEAD}", "path")
    structure = model.structure
    if isinstance(structure, DiscreteTimeStructure | DiscreteStateSpaceStructure) and not getattr(
        structure, "delay", False
    ):
        if is_state_space(structure) and model.state_space is not None and model.state_space.matrices is None:
            raise UnprocessableError.at(
                "/modelId", "this model is one of single operating points only; it cannot follow p(t)", "path"
            )
        return structure.sample_time_seconds
    what = "an estimated delay" if not isinstance(structure, ContinuousTimeStructure) else "continuous time"
    raise UnprocessableError.at(
        "/modelId",
        f"along p(t) only models in discrete time without an estimated delay are simulated, this has {what}; {INSTEAD}",
        "path",
    )


def _excitation(
    container: Container, plant: Plant, sample_time: float, request: SimulationRequest
) -> tuple[Arrays, dict[str, str]]:
    """Input (N, n_u) and scheduling (N, s), and where they stand in the request."""
    asked = request.excitation
    if isinstance(asked, GivenExcitation):
        pointers = {"input": "/excitation/inputs", "scheduling": "/excitation/scheduling"}
        with pointing(pointers):
            arrays = {"input": stacked(asked.inputs, "input"), "scheduling": stacked(asked.scheduling, "scheduling")}
        return arrays, pointers
    if isinstance(asked, ExperimentExcitation):
        pointer = "/excitation/experimentId"
        return _of_experiment(container, plant, sample_time, asked.experiment_id), dict.fromkeys(
            ("input", "scheduling"), pointer
        )
    assert isinstance(asked, SignalExcitation), "steady states have a payload of their own"
    return _of_signal(container, plant, asked), dict.fromkeys(("input", "scheduling"), "/excitation/signalsId")


def _of_experiment(container: Container, plant: Plant, sample_time: float, experiment_id: str) -> Arrays:
    pointer = "/excitation/experimentId"
    row = of_plant(named(container.resources, "experiments", experiment_id, pointer), plant.id, pointer)
    experiment = experiment_of(row)
    if experiment.kind not in ("timeRecord", "varyingRecord"):
        raise UnprocessableError.at(pointer, "this is a frequency response; nothing was played in it over time")
    check_sample_time(experiment, sample_time, pointer)
    arrays = container.arrays.get(row.arrays or "")
    if experiment.kind == "varyingRecord":
        return {name: arrays[name] for name in ("input", "scheduling")}
    u = arrays["input"][:, None]
    return {"input": u, "scheduling": np.tile(np.array(experiment.held_at), (len(u), 1))}


def _of_signal(container: Container, plant: Plant, asked: SignalExcitation) -> Arrays:
    period, signal = designed_signal(container, plant, asked.signals_id, asked.index)
    u = np.tile(period, signal.periods)[:, None]
    return {"input": u, "scheduling": np.tile(np.array(signal.operating_point), (len(u), 1))}


def _check(plant: Plant, arrays: Arrays, pointers: dict[str, str]) -> None:
    """Raises UnprocessableError for other channels than the plant's, unequal lengths, and too many samples."""
    expected = {"input": channels(plant)[1], "scheduling": len(plant.scheduling_variables)}
    for name, count in expected.items():
        found = arrays[name].shape[1]
        if found != count:
            raise UnprocessableError.at(pointers[name], f"{found} lists are given, the plant needs {count}")
    samples, others = len(arrays["input"]), len(arrays["scheduling"])
    if samples != others:
        raise UnprocessableError.at(
            pointers["scheduling"], f"the scheduling has {others} samples, the input {samples}; give equal lengths"
        )
    if not 1 <= samples <= MOST_SAMPLES:
        raise UnprocessableError.at(pointers["input"], f"{samples} samples; give between 1 and {MOST_SAMPLES}")


def simulation_of(resource: Resource) -> Simulation:
    """The simulation in a row."""
    return Simulation.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, simulation_id: str) -> Simulation:
    """The simulation of an identifier."""
    return simulation_of(resources.get(KIND, simulation_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> SimulationList:
    """Part of the list of simulations."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return SimulationList(items=items(found, simulation_of), next_cursor=found.next_cursor)


def data(container: Container, simulation_id: str) -> SimulationData:
    """The samples as JSON."""
    resource = container.resources.get(KIND, simulation_id)
    arrays = container.arrays.get(resource.arrays or "")
    band = _band(arrays)
    return SimulationData(
        simulation_id=simulation_id,
        sample_time_seconds=simulation_of(resource).sample_time_seconds,
        inputs=arrays["input"].T.tolist(),
        scheduling=arrays["scheduling"].T.tolist(),
        outputs=arrays["output"].T.tolist(),
        operating_points=None if "operatingPoints" not in arrays else arrays["operatingPoints"].tolist(),
        lower95=None if band is None else band[0].T.tolist(),
        upper95=None if band is None else band[1].T.tolist(),
    )


def as_file(container: Container, simulation_id: str, file_format: Format) -> bytes:
    """Time and one column a channel: u1, y1, p1, …, and lower1, upper1 of each output where they are known.

    Of a steady state y1, y2, … are at the operating points, and p1, … stands in the file of a single one.
    """
    resource = container.resources.get(KIND, simulation_id)
    arrays = container.arrays.get(resource.arrays or "")
    columns: Arrays = {"time": np.arange(len(arrays["output"])) * simulation_of(resource).sample_time_seconds}
    parts = {"u": arrays["input"], "y": arrays["output"], "p": arrays["scheduling"]}
    band = _band(arrays)
    if band is not None:
        parts |= {"lower": band[0], "upper": band[1]}
    for name, values in parts.items():
        columns |= {f"{name}{i + 1}": column for i, column in enumerate(values.T)}
    return arrays_file(columns, file_format)


def _band(arrays: Arrays) -> tuple[NDArray[Any], NDArray[Any]] | None:
    """Ends of the 95 % band (N, n_y)."""
    if "deviation" not in arrays:
        return None
    half = QUANTILE_95 * arrays["deviation"]
    return arrays["output"] - half, arrays["output"] + half
