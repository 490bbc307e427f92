"""Comparisons: asked for, made in a job, and their maps."""

from typing import Any

from numpy.typing import NDArray

from app.arrays import ComplexVector
from app.container import Container
from app.errors import NotFoundError, UnprocessableError
from app.files.stored import Format, arrays_file
from app.jobs.records import JobRecord
from app.schemas.comparisons import (
    ComparedExperiment,
    ComparedResponse,
    Comparison,
    ComparisonList,
    ComparisonMaps,
    ComparisonRequest,
    Data,
    LineClass,
    ResidualRow,
    TimeResidualRow,
)
from app.schemas.models import Model
from app.schemas.plants import Plant
from app.services.documents import fields, items, named
from app.services.jobs import fingerprint
from app.services.measured import (
    Measured,
    check_logged,
    check_time_domain,
    fitted_experiments,
    measured_of_plant,
    payload_of,
)
from app.services.models import model_of
from app.services.plants import plant_of
from app.store.resources import Resource, ResourceRepository

KIND = "comparisons"
LINE_CLASSES: tuple[LineClass, ...] = ("excited", "unexcitedOdd", "unexcitedEven")


def submit(container: Container, request: ComparisonRequest, key: str | None) -> JobRecord:
    """Start the job that holds a model against experiments."""
    resources = container.resources
    model = model_of(named(resources, "models", request.model_id, "/modelId"))
    plant = plant_of(resources.get("plants", model.plant_id))
    experiments = measured_of_plant(
        resources, request.experiment_ids, plant.id, "/experimentIds", along=model.varying is not None
    )
    task = payload(plant, model, request, experiments, fitted_experiments(resources, model))
    mark = fingerprint("createComparison", request.model_dump(mode="json"))
    return container.ledger.submit("comparison", task, KIND, plant.id, key, mark)


def payload(
    plant: Plant, model: Model, request: ComparisonRequest, experiments: list[Measured], fitted: set[str]
) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when model and experiments cannot be compared."""
    check_time_domain(model, experiments, "/experimentIds")
    check_logged(model, experiments, "/experimentIds")
    data: list[Data] = ["fitted" if experiment.id in fitted else "heldOut" for experiment, _ in experiments]
    if "heldOut" in data and (model.joint_covariance if model.effects else model.covariance) is None:
        raise UnprocessableError.at(
            "/modelId",
            "the model has no covariance, so that nobody can say how far it may be from data that it was not fitted"
            " to; state its covariance, or identify it from these experiments",
        )
    return {
        "plant": plant.as_json(),
        "model": model.as_json(),
        "request": request.as_json(),
        "experiments": payload_of(experiments),
        "data": data,
    }


def comparison_of(resource: Resource) -> Comparison:
    """The comparison in a row."""
    return Comparison.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, comparison_id: str) -> Comparison:
    """The comparison of an identifier."""
    return comparison_of(resources.get(KIND, comparison_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> ComparisonList:
    """Part of the list of comparisons."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return ComparisonList(items=items(found, comparison_of), next_cursor=found.next_cursor)


def maps(container: Container, comparison_id: str) -> ComparisonMaps:
    """The normalised residuals as JSON."""
    resource = container.resources.get(KIND, comparison_id)
    arrays = container.arrays.get(resource.arrays or "")
    experiments = enumerate(comparison_of(resource).experiments)
    rows: list[ResidualRow] = []
    over_time: list[TimeResidualRow] = []
    for place, experiment in experiments:
        if experiment.operating_point is None:
            rows += _rows_of_outputs(place, experiment, arrays)
            over_time += _over_time(place, experiment, arrays)
        else:
            rows.append(_row(place, experiment, arrays))
    return ComparisonMaps(comparison_id=comparison_id, rows=rows, time_rows=over_time)


def response(container: Container, comparison_id: str, experiment_id: str) -> ComparedResponse:
    """Measured and modelled response of one experiment as JSON; raises NotFoundError when it was not compared."""
    resource = container.resources.get(KIND, comparison_id)
    compared = comparison_of(resource).experiments
    arrays = container.arrays.get(resource.arrays or "")
    place = next((i for i, one in enumerate(compared) if one.experiment_id == experiment_id), None)
    point = None if place is None else compared[place].operating_point
    if place is None or point is None or f"measured{place}" not in arrays:
        raise NotFoundError(f"comparison {comparison_id} holds no response of experiment {experiment_id!r}")
    deviation = arrays.get(f"deviation{place}")
    return ComparedResponse(
        comparison_id=comparison_id,
        experiment_id=experiment_id,
        operating_point=point,
        data=compared[place].data,
        frequencies_rad_per_second=arrays[f"excitedRadPerSecond{place}"].tolist(),
        measured=ComplexVector.of(arrays[f"measured{place}"]),
        standard_deviation=None if deviation is None else deviation.tolist(),
        modelled=ComplexVector.of(arrays[f"modelled{place}"]),
    )


def as_file(container: Container, comparison_id: str, file_format: Format) -> bytes:
    """The same as a file: arrays numbered by the place of the experiment, line classes 0, 1, 2."""
    resource = container.resources.get(KIND, comparison_id)
    return arrays_file(container.arrays.get(resource.arrays or ""), file_format)


def _rows_of_outputs(place: int, experiment: ComparedExperiment, arrays: dict[str, NDArray[Any]]) -> list[ResidualRow]:
    """One row an output, of a record along varying scheduling."""
    columns = arrays[f"residual{place}"].T
    one = [_row(place, experiment, {**arrays, f"residual{place}": column}) for column in columns]
    return [row.model_copy(update={"output_number": i + 1}) for i, row in enumerate(one)]


def _over_time(place: int, experiment: ComparedExperiment, arrays: dict[str, NDArray[Any]]) -> list[TimeResidualRow]:
    return [
        TimeResidualRow(
            experiment_id=experiment.experiment_id,
            output_number=i + 1,
            data=experiment.data,
            sample_time_seconds=float(arrays[f"sampleTimeSeconds{place}"]),
            residual=column.tolist(),
        )
        for i, column in enumerate(arrays[f"timeResidual{place}"].T)
    ]


def _row(place: int, experiment: ComparedExperiment, arrays: dict[str, NDArray[Any]]) -> ResidualRow:
    return ResidualRow(
        experiment_id=experiment.experiment_id,
        operating_point=experiment.operating_point,
        data=experiment.data,
        frequencies_rad_per_second=arrays[f"frequenciesRadPerSecond{place}"].tolist(),
        residual=ComplexVector.of(arrays[f"residual{place}"]),
        line_classes=[LINE_CLASSES[number] for number in arrays[f"lineClass{place}"]],
    )
