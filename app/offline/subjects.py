"""The plant and the model of a request file."""

from pathlib import Path
from typing import Any

from app.errors import UnprocessableError
from app.offline.documents import checked, load, section
from app.offline.workplace import MODEL_ID, PLANT_ID, stored
from app.schemas.models import Model, StatedModelRequest
from app.schemas.plants import Plant, PlantRequest
from app.services import models, plants


def plant_in(content: dict[str, Any]) -> Plant:
    """The plant that a request file describes."""
    return described_plant(checked(PlantRequest, section(content, "plant"), "/plant"))


def described_plant(request: PlantRequest) -> Plant:
    """The plant of a description."""
    return Plant.model_validate(stored(plants.described(request), PLANT_ID))


def model_in(content: dict[str, Any], plant: Plant, folder: Path) -> Model:
    """A stated model, or the model.json that `identify` or `extend` wrote."""
    given = section(content, "model")
    if isinstance(given, str):
        if not (folder / given).is_file():
            raise UnprocessableError.at("/model", f"there is no file {folder / given}")
        return checked(Model, {**load(folder / given), "plantId": PLANT_ID}, "/model")
    request = checked(StatedModelRequest, {"plantId": PLANT_ID, **given}, "/model")
    return Model.model_validate(stored(models.stated(plant, request), MODEL_ID, plantId=PLANT_ID, jobId=None))
