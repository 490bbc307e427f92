"""The experiments of a request file: data in it, or names of data files."""

from pathlib import Path
from typing import Any

from rich.console import Console

from app.errors import UnprocessableError
from app.offline.documents import checked
from app.offline.workplace import PLANT_ID, Workplace, stored
from app.schemas.experiments import Experiment, ExperimentRequest, FileFields
from app.schemas.plants import Plant
from app.services import experiments


def experiments_of(place: Workplace, plant: Plant, given: Any, folder: Path) -> list[tuple[Experiment, str]]:
    """The experiments with the hashes of their arrays, named experiment1, experiment2, …"""
    if not isinstance(given, list) or not all(isinstance(one, dict) for one in given):
        raise UnprocessableError.at("/experiments", "must be a list of experiments")
    return [_experiment(place, plant, one, folder, i) for i, one in enumerate(given)]


def _experiment(
    place: Workplace, plant: Plant, given: dict[str, Any], folder: Path, index: int
) -> tuple[Experiment, str]:
    pointer = f"/experiments/{index}"
    stated = {"plantId": PLANT_ID, **{name: value for name, value in given.items() if name != "file"}}
    if "file" in given:
        path = folder / str(given["file"])
        if not path.is_file():
            raise UnprocessableError.at(f"{pointer}/file", f"there is no file {path}")
        request = checked(FileFields, stated, pointer)
        payload, arrays = experiments.file_payload(plant, request, path.read_bytes(), path.name)
        experiments.check_point(plant, request, f"{pointer}/operatingPoint")
    else:
        body = checked(ExperimentRequest, stated, pointer)
        payload, arrays = experiments.json_payload(plant, body)
        experiments.check_point(plant, body.root, f"{pointer}/operatingPoint")
    found = place.run("experiment", {**payload, "arrays": place.arrays.put(arrays)})
    document = stored(found.document, f"experiment{index + 1}", jobId=None)
    experiment = Experiment.model_validate(document)
    for warning in experiment.understood.warnings:
        Console(stderr=True).print(
            f"experiment {index + 1} ({experiment.name or experiment.id}): {warning}", markup=False
        )
    return experiment, found.arrays or ""
