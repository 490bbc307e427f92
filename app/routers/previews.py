"""Previews: look into a file before it is brought in."""

from typing import Annotated

from fastapi import APIRouter, Depends, Form, Response

from app.dependencies import ContainerDependency, IdempotencyKey, ResourcesDependency
from app.forms import checked_form, known_fields
from app.routers.experiments import Upload
from app.schemas.experiments import FileFields
from app.schemas.jobs import Job
from app.schemas.previews import Preview
from app.services import previews
from app.services.jobs import accepted

router = APIRouter(prefix="/previews", tags=["previews"])


@router.post("", status_code=202, dependencies=[Depends(known_fields)])
def create_preview(
    container: ContainerDependency,
    response: Response,
    file: Upload,
    plant_id: Annotated[str, Form(alias="plantId", description="the plant that was measured")],
    columns: Annotated[list[str] | None, Form(description="which column or array is what, e.g. input=force")] = None,
    units: Annotated[list[str] | None, Form(description="units of columns, e.g. Frequency=Hz")] = None,
    rows: Annotated[list[str] | None, Form(description="only the lines with these values, e.g. run=2")] = None,
    sample_time: Annotated[float | None, Form(alias="sampleTimeSeconds", allow_inf_nan=False)] = None,
    period: Annotated[int | None, Form(alias="periodSamples")] = None,
    group: Annotated[str, Form(alias="variableGroup", description="the table that is meant")] = "",
    averages: Annotated[int | None, Form(description="independent averages behind a coherence")] = None,
    key: IdempotencyKey = None,
) -> Job:
    """Look into a file: its columns with first rows, what each would be taken for, units, and a small picture.

    No experiment is made. Where something cannot be known, `problem` of the preview asks for it. What was stated of
    the columns of the plant's last file is used again where the columns are the same and nothing is stated.
    """
    stated = checked_form(
        FileFields,
        {
            "plantId": plant_id,
            "columns": columns or [],
            "units": units or [],
            "rows": rows or [],
            "sampleTimeSeconds": sample_time,
            "periodSamples": period,
            "variableGroup": group,
            "averages": averages,
        },
    )
    record = previews.submit(container, stated, file.file.read(), file.filename or "", key)
    return accepted(record, response)


@router.get("/{previewId}")
def get_preview(previewId: str, resources: ResourcesDependency) -> Preview:
    """What was seen in a file."""
    return previews.get(resources, previewId)
