"""Reports of all that led to a model."""

from app.schemas.common import CamelModel, Integer, Timestamp
from app.schemas.plants import Text


class ReportRequest(CamelModel):
    """How the report is to be called."""

    name: Text = ""


class Report(CamelModel):
    """A page with all figures that works without a network; it is found under `/file`."""

    id: str
    created_at: Timestamp
    software_version: str
    plant_id: str
    job_id: str | None
    name: Text
    model_id: str
    version_ids: list[str]
    experiment_ids: list[str]
    design_ids: list[str]
    comparison_ids: list[str]
    diagnosis_ids: list[str]
    bytes: Integer


class ReportList(CamelModel):
    """A page of reports."""

    items: list[Report]
    next_cursor: str | None = None
