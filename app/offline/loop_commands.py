"""The commands `compare`, `diagnose` and `extend`."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from app.offline import results
from app.offline.documents import load, section
from app.offline.explained import explained
from app.offline.loop import Loop, loop_of
from app.offline.subjects import model_in, plant_in
from app.offline.workplace import workplace
from app.schemas.diagnoses import Diagnosis
from app.schemas.models import Model


@explained
def compare(file: Path, output: Path, report: Path | None) -> None:
    """Hold the model of a request file against its experiments."""
    with _begun(file) as (content, model, loop):
        compared = loop.compare(model, content.get("compare"))
        results.write_comparison(output, compared)
        if report is not None:
            results.write_report(report, loop.chain([model], [compared], []))


@explained
def diagnose(file: Path, output: Path, add: bool, report: Path | None) -> None:
    """Look for what the model of a request file lacks; with `add`, add the best effect and refit."""
    with _begun(file) as (content, model, loop):
        found = loop.diagnose(model, content.get("diagnose"))
        results.write_diagnosis(output, found)
        versions = [model]
        if add and found.announced:
            versions.append(loop.extend(model, _as_diagnosed(found)))
            results.write_model(output, versions[-1], [])
        if report is not None:
            _report(report, loop, versions, [found], content)


@explained
def extend(file: Path, output: Path, report: Path | None) -> None:
    """Add the effect that a request file names to its model, and refit."""
    with _begun(file) as (content, model, loop):
        grown = loop.extend(model, section(content, "extend"))
        results.write_model(output, grown, [])
        if report is not None:
            _report(report, loop, [model, grown], [], content)


@contextmanager
def _begun(file: Path) -> Iterator[tuple[dict[str, Any], Model, Loop]]:
    """What a request file holds, its model, and its experiments in a workplace."""
    content = load(file)
    plant = plant_in(content)
    model = model_in(content, plant, file.parent)
    with workplace() as place:
        yield content, model, loop_of(place, plant, section(content, "experiments"), file.parent)


def _as_diagnosed(found: Diagnosis) -> dict[str, Any]:
    return {
        "effect": found.announced[0],
        "amplitudeDegree": found.amplitude_degree,
        "meanValue": found.mean_value,
        "seed": found.seed,
    }


def _report(
    report: Path, loop: Loop, versions: list[Model], diagnosed: list[Diagnosis], content: dict[str, Any]
) -> None:
    """Every version compared; without held-out experiments for a model whose covariance is not known."""
    compared = []
    for model in versions:
        known = model.joint_covariance if model.effects else model.covariance
        own = loop if known is not None else Loop(loop.place, loop.plant, tuple(loop.fitted))
        compared.append(own.compare(model, content.get("compare")))
    results.write_report(report, loop.chain(versions, compared, diagnosed))
