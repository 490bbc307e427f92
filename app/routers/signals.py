"""Signals: look at them, take them out."""

from typing import Annotated, get_args

from fastapi import APIRouter, Query, Response

from app.dependencies import ContainerDependency, Cursor, Limit, ResourcesDependency
from app.files.stored import SignalFormat
from app.routers.downloads import file_answer, file_response
from app.schemas.signals import Signals, SignalsList
from app.services import signal_files, signals

router = APIRouter(prefix="/signals", tags=["signals"])


@router.get("")
def list_signals(
    resources: ResourcesDependency,
    plant_id: Annotated[str | None, Query(alias="plantId", max_length=64, description="only of this plant")] = None,
    limit: Limit = 50,
    cursor: Cursor = None,
) -> SignalsList:
    """Signals of designs, newest first."""
    return signals.page(resources, plant_id, limit, cursor)


@router.get("/{signalsId}")
def get_signals(signalsId: str, resources: ResourcesDependency) -> Signals:
    """The signals of one design: levels, crest factors, achieved spectra."""
    return signals.get(resources, signalsId)


@router.get("/{signalsId}/file", response_class=Response, responses=file_answer(*get_args(SignalFormat)))
def get_signal_file(
    signalsId: str,
    container: ContainerDependency,
    format: Annotated[SignalFormat, Query()] = "npz",
    index: Annotated[int, Query(ge=0, le=100_000, description="which of the signals, from zero")] = 0,
) -> Response:
    """All samples of one signal, every period: csv, npz and mat have time and input; wav has full scale at the peak."""
    content = signal_files.samples_file(container, signalsId, index, format)
    return file_response(content, f"signal-{signalsId}-{index}", format)
