"""Experiments: bring data in, look at it, take it out."""

import json
from typing import Annotated, Any, get_args

from fastapi import APIRouter, Depends, File, Form, Query, Response, UploadFile

from app.dependencies import ContainerDependency, Cursor, IdempotencyKey, Limit, ResourcesDependency
from app.files.stored import Format
from app.forms import checked_form, known_fields
from app.routers.downloads import file_answer, file_response
from app.schemas.conditions import InputHold
from app.schemas.experiments import (
    Experiment,
    ExperimentData,
    ExperimentList,
    ExperimentRequest,
    FileFields,
    RecordSpectrumDocument,
)
from app.schemas.jobs import Job
from app.schemas.measured_responses import MeasuredResponseDocument
from app.services import experiment_data, experiments, measured_responses
from app.services.jobs import accepted

router = APIRouter(prefix="/experiments", tags=["experiments"])

Finite = Annotated[float, Form(allow_inf_nan=False)]
Upload = Annotated[
    UploadFile,
    File(
        description="a text with columns, .npz, .mat, or another kind of file that a reader takes",
        json_schema_extra={"format": "binary"},
    ),
]


@router.post("", status_code=202)
def create_experiment(
    body: ExperimentRequest, container: ContainerDependency, response: Response, key: IdempotencyKey = None
) -> Job:
    """Bring in a time record, a frequency response or a record along varying scheduling as JSON."""
    return accepted(experiments.submit(container, body, key), response)


@router.post("/files", status_code=202, dependencies=[Depends(known_fields)])
def upload_experiment(
    container: ContainerDependency,
    response: Response,
    file: Upload,
    plant_id: Annotated[str, Form(alias="plantId", description="the plant that was measured")],
    operating_point: Annotated[
        list[Finite] | None,
        Form(
            alias="operatingPoint",
            description="one value a scheduling variable; left out when the file holds the scheduling signals",
        ),
    ] = None,
    scheduling_columns: Annotated[
        list[str] | None,
        Form(alias="schedulingColumns", description="columns of the scheduling signals, where they have other names"),
    ] = None,
    name: Annotated[str, Form()] = "",
    description: Annotated[str, Form()] = "",
    design_id: Annotated[str | None, Form(alias="designId", description="the design that is carried out")] = None,
    sample_time: Annotated[
        float | None,
        Form(alias="sampleTimeSeconds", allow_inf_nan=False, description="needed when the file has no time"),
    ] = None,
    period: Annotated[int | None, Form(alias="periodSamples", description="samples in one period")] = None,
    group: Annotated[
        str, Form(alias="variableGroup", description="structure of a mat file that holds the arrays, e.g. data.run1")
    ] = "",
    columns: Annotated[list[str] | None, Form(description="which column or array is what, e.g. input=force")] = None,
    units: Annotated[list[str] | None, Form(description="units of columns, e.g. Frequency=Hz")] = None,
    rows: Annotated[list[str] | None, Form(description="only the lines with these values, e.g. run=2")] = None,
    operating_point_columns: Annotated[
        list[str] | None,
        Form(alias="operatingPointColumns", description="columns of the operating point; one experiment for each"),
    ] = None,
    averages: Annotated[int | None, Form(description="independent averages behind a coherence")] = None,
    logged: Annotated[
        str, Form(alias="loggedQuantities", description='quantities written down, as JSON: [{"name", "unit", "value"}]')
    ] = "[]",
    input_level: Annotated[
        float | None,
        Form(alias="inputLevel", allow_inf_nan=False, description="value of the input at the operating point"),
    ] = None,
    output_level: Annotated[
        float | None,
        Form(alias="outputLevel", allow_inf_nan=False, description="value of the output when the input stands there"),
    ] = None,
    input_hold: Annotated[
        InputHold | None, Form(alias="inputHold", description="how the input runs between its samples")
    ] = None,
    feedback: Annotated[bool, Form(description="whether a controller acted on the output while recording")] = False,
    key: IdempotencyKey = None,
) -> Job:
    """Bring in a file; its columns or arrays are found by their names and units, or as `columns` and `units` say.

    A time record has input, output and time (or state sampleTimeSeconds). A frequency response has frequencies with
    their unit, complex values (or real and imaginary parts, or magnitude and phase) and, where known, their variance,
    deviations, or coherence with `averages`. Values are converted to the units of the plant. A table with a column for
    each scheduling variable gives one experiment for each operating point.
    A record along varying scheduling states no operatingPoint; it has u, y and p (or u1, u2, … and the names of the
    scheduling variables) and time.
    """
    stated = checked_form(
        FileFields,
        {
            "plantId": plant_id,
            "operatingPoint": operating_point,
            "schedulingColumns": scheduling_columns,
            "name": name,
            "description": description,
            "designId": design_id,
            "sampleTimeSeconds": sample_time,
            "periodSamples": period,
            "variableGroup": group,
            "columns": columns or [],
            "units": units or [],
            "rows": rows or [],
            "operatingPointColumns": operating_point_columns,
            "averages": averages,
            "loggedQuantities": _json(logged),
            "inputLevel": input_level,
            "outputLevel": output_level,
            "inputHold": input_hold,
            "feedback": feedback,
        },
    )
    record = experiments.submit_file(container, stated, file.file.read(), file.filename or "", key)
    return accepted(record, response)


def _json(text: str) -> Any:
    """What a form field holds as JSON; the text itself, which no schema takes, when it is none."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


@router.get("")
def list_experiments(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> ExperimentList:
    """Experiments, newest first."""
    return experiments.page(resources, plant_id, limit, cursor)


@router.get("/{experimentId}")
def get_experiment(experimentId: str, resources: ResourcesDependency) -> Experiment:
    """One experiment, with what was understood of it."""
    return experiments.get(resources, experimentId)


@router.get("/{experimentId}/data")
def get_experiment_data(experimentId: str, container: ContainerDependency) -> ExperimentData:
    """The arrays of an experiment as JSON."""
    return experiment_data.as_document(container, experimentId)


@router.get("/{experimentId}/spectrum")
def get_experiment_spectrum(experimentId: str, container: ContainerDependency) -> RecordSpectrumDocument:
    """The amplitudes of input, output and noise of a time record over frequency."""
    return experiment_data.spectrum(container, experimentId)


@router.get("/{experimentId}/frequency-response")
def get_measured_response(experimentId: str, container: ContainerDependency) -> MeasuredResponseDocument:
    """The response of an experiment of one channel, with its noise; of impedances the linear Kramers–Kronig test."""
    return measured_responses.measured(container, experimentId)


@router.get("/{experimentId}/file", response_class=Response, responses=file_answer(*get_args(Format)))
def get_experiment_file(
    experimentId: str, container: ContainerDependency, format: Annotated[Format, Query()] = "npz"
) -> Response:
    """The arrays of an experiment as a file that can be brought in again."""
    content = experiment_data.as_file(container, experimentId, format)
    return file_response(content, f"experiment-{experimentId}", format)
