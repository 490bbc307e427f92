"""Signals: asked for, and made in a job."""

from typing import Any

from app.container import Container
from app.conversion.signals import lengths
from app.errors import UnprocessableError
from app.jobs.records import JobRecord
from app.schemas.designs import Design
from app.schemas.signals import Signals, SignalsList, SignalsRequest
from app.services.designs import design_of
from app.services.documents import fields, items
from app.services.jobs import fingerprint
from app.store.resources import Resource, ResourceRepository

KIND = "signals"
MOST_SAMPLES = 4_000_000


def submit(container: Container, design_id: str, request: SignalsRequest, key: str | None) -> JobRecord:
    """Start the job that makes the signals of a design."""
    design = design_of(container.resources.get("designs", design_id))
    mark = fingerprint("createSignals", design_id, request.model_dump(mode="json"))
    return container.ledger.submit("signals", payload(design, request), KIND, design.plant_id, key, mark)


def payload(design: Design, request: SignalsRequest) -> dict[str, Any]:
    """What the task gets; raises UnprocessableError when there is nothing to play or too much."""
    if not design.experiments:
        raise UnprocessableError("the design has no experiments: " + (design.outcome.advice or "none are needed"))
    for experiment in design.experiments:
        period, periods = lengths(design, experiment, request)
        if period * periods > MOST_SAMPLES:
            detail = (
                f"{period} samples in {periods} periods are too many; at most {MOST_SAMPLES} are made for one signal"
            )
            raise UnprocessableError.at("/samples", detail)
    if request.method == "filtered_noise" and any(e.spectrum.kind != "fir" for e in design.experiments):
        raise UnprocessableError.at("/method", "noise has no lines; play a design with line spectra as a multisine")
    return {"design": design.as_json(), "request": request.as_json()}


def signals_of(resource: Resource) -> Signals:
    """The signals in a row."""
    return Signals.model_validate(fields(resource, "plantId", "jobId"))


def get(resources: ResourceRepository, signals_id: str) -> Signals:
    """The signals of an identifier."""
    return signals_of(resources.get(KIND, signals_id))


def page(resources: ResourceRepository, plant_id: str | None, limit: int, cursor: str | None) -> SignalsList:
    """Part of the list of signals."""
    found = resources.list(KIND, plant_id, limit, cursor)
    return SignalsList(items=items(found, signals_of), next_cursor=found.next_cursor)
