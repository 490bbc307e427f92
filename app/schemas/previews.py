"""Previews: what a file would be taken for, before it is brought in."""

from typing import Literal

from pydantic import Field

from app.schemas.common import CamelModel, Double, FieldProblem, Integer, Timestamp
from app.schemas.experiments import ExperimentKind, Values


class ColumnPreview(CamelModel):
    """A column or array of the file."""

    name: str
    unit: str = Field(description="as it stands in the file or was stated; empty where nothing says it")
    taken_for: str = Field(description="what it is: time, input, frequency, real, …; empty where it is not used")
    sign: Literal[1, -1] = Field(description="-1 where the column holds the negative")
    first_values: list[str]
    count: Integer = Field(description="how many values it has")


class Curve(CamelModel):
    """One curve of the picture; null where a value is not finite."""

    name: str
    values: list[Double | None]


class PreviewPicture(CamelModel):
    """A small picture: curves over time or frequency, thinned to some hundred points."""

    abscissa: Literal["timeSeconds", "frequenciesRadPerSecond"]
    values: Values
    curves: list[Curve]


class Preview(CamelModel):
    """What a file would be taken for as things are stated, and what is still to be said."""

    id: str
    created_at: Timestamp
    job_id: str | None
    software_version: str
    plant_id: str
    source: str = Field(description="the kind of file")
    file_name: str
    tables: list[str] = Field(description="names of sheets, structures or groups; one of them is the variableGroup")
    variable_group: str = Field(description="the table whose columns are shown")
    columns: list[ColumnPreview]
    stated_columns: list[str] = Field(description="what was stated of columns, or remembered of the plant's last file")
    stated_units: list[str] = Field(description="likewise of units")
    remembered: bool = Field(description="these come from an earlier file of the plant with the same columns")
    kind: ExperimentKind | None = Field(
        default=None, description="what would be made of it; null while it is not clear"
    )
    sample_time_seconds: Double | None = Field(default=None, description="of a record")
    warnings: list[str] = Field(description="what would be assumed, and what may spoil an identification")
    problem: FieldProblem | None = Field(default=None, description="the question that is to be answered first")
    picture: PreviewPicture | None = None
