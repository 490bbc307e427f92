"""What the commands leave behind, and what they say about it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel
from rich.console import Console
from rich.table import Table

from app.files import npz_writer
from app.files.stored import arrays_file
from app.report.effect_text import amplitude
from app.schemas.designs import Design
from app.schemas.diagnoses import Diagnosis
from app.schemas.experiments import Experiment
from app.schemas.models import Model
from app.schemas.outcomes import TestDocument
from app.schemas.signals import Signals
from app.schemas.state_space import StateSpaceResult

if TYPE_CHECKING:
    from app.report.chain.documents import Chain, Compared

MOST_RANKED = 10


def write_model(folder: Path, model: Model, experiments: Sequence[Experiment]) -> None:
    """model.json, model.npz (theta, covariance, local coefficients or matrices), experiments.json."""
    _write(folder, "model.json", model)
    arrays = {"theta": np.array(model.theta)}
    if model.state_space is None:
        arrays["operatingPoints"] = np.array([local.operating_point for local in model.local_models])
        arrays["zeta"] = np.array([local.zeta for local in model.local_models])
    else:
        arrays |= _matrices(model.state_space)
    if model.covariance is not None:
        arrays["covariance"] = np.array(model.covariance)
    (folder / "model.npz").write_bytes(npz_writer.write(arrays))
    for experiment in experiments:
        _write(folder, f"{experiment.id}.json", experiment)
    table = Table("parameter", "value", "standard deviation", title=f"identification {_status(model.outcome)}")
    deviations = model.standard_deviations or [float("nan")] * len(model.theta)
    for name, value, deviation in zip(model.parameter_names, model.theta, deviations, strict=True):
        table.add_row(name, f"{value:.6g}", f"{deviation:.3g}")
    if model.effects:
        Console().print(_effects(model))
    _say(folder, table)


def _matrices(found: StateSpaceResult) -> dict[str, NDArray[Any]]:
    """a, b, c, d of each basis function, and those of each local model as a1, b1, …, a2, …"""
    sources = [("", found.matrices), *((str(i + 1), local) for i, local in enumerate(found.local_models))]
    return {
        f"{name}{number}": np.array(getattr(source, f"matrix_{name}"))
        for number, source in sources
        if source is not None
        for name in "abcd"
    }


def _effects(model: Model) -> Table:
    errors = model.extension
    title = ""
    if errors is not None:
        title = f"error {errors.before.fitted:.3g} → {errors.after.fitted:.3g}"
        if errors.before.held_out is not None and errors.after.held_out is not None:
            title += f", held out {errors.before.held_out:.3g} → {errors.after.held_out:.3g}"
    table = Table("effect", "amplitude", title=title)
    for one in model.effects:
        table.add_row(one.title, amplitude(one))
    return table


def write_design(folder: Path, design: Design) -> None:
    """design.json."""
    _write(folder, "design.json", design)
    energy = "no energy" if design.total_energy is None else f"energy {design.total_energy:.6g}"
    gap = "" if design.gap is None else f", certified gap {design.gap:.1e}"
    table = Table("operating point", "energy", title=f"design {_status(design.outcome)}: {energy}{gap}")
    for experiment in design.experiments:
        table.add_row(", ".join(f"{value:g}" for value in experiment.operating_point), f"{experiment.energy:.6g}")
    _say(folder, table)


def write_signals(folder: Path, signals: Signals, arrays: Mapping[str, NDArray[Any]]) -> None:
    """signals.json, and signal-0.csv, signal-0.npz, … with all samples."""
    _write(folder, "signals.json", signals)
    table = Table("signal", "operating point", "samples", "peak", "crest factor", title="signals")
    for signal in signals.signals:
        record = np.tile(arrays[f"period{signal.index}"], signal.periods)
        samples = {"time": np.arange(len(record)) * signal.sample_time_seconds, "input": record}
        (folder / f"signal-{signal.index}.csv").write_bytes(arrays_file(samples, "csv"))
        (folder / f"signal-{signal.index}.npz").write_bytes(arrays_file(samples, "npz"))
        point = ", ".join(f"{value:g}" for value in signal.operating_point)
        numbers = (str(signal.samples), f"{signal.peak:.4g}", f"{signal.crest_factor:.3f}")
        table.add_row(str(signal.index), point, *numbers)
    _say(folder, table)


def write_comparison(folder: Path, compared: "Compared") -> None:
    """comparison.json, comparison.npz with the normalised residuals of each experiment."""
    found = compared.document
    _write(folder, "comparison.json", found)
    (folder / "comparison.npz").write_bytes(npz_writer.write(dict(compared.arrays)))
    fits = Table("experiment", "operating point", "data", "fit %", "after a refit %", title="comparison")
    for one in found.experiments:
        point = ", ".join(f"{value:g}" for value in one.operating_point or ()) or "varying"
        percents = ("–" if value is None else f"{value:.2f}" for value in (one.fit_percent, one.refit_percent))
        fits.add_row(one.experiment_id, point, one.data, *percents)
    Console().print(fits)
    table = Table("lack of fit", "χ²", "degrees of freedom", "p-value")
    for part in found.parts:
        named: list[tuple[str, TestDocument | None]] = [(part.data, part.lack_of_fit)]
        named += [(f"{part.data}, after a refit", part.refitted)]
        named += [(f"{part.data}, {one.name} lines", one) for one in part.by_line_class]
        for name, test in named:
            if test is not None and test.statistic is not None:
                table.add_row(name, f"{test.statistic:.5g}", f"{test.degrees_of_freedom:g}", f"{test.p_value:.2g}")
    _say(folder, table)


def write_diagnosis(folder: Path, found: Diagnosis) -> None:
    """diagnosis.json."""
    _write(folder, "diagnosis.json", found)
    names = ", ".join(found.announced) or "no effect announced"
    table = Table("effect", "weight", "amplitude", "p adjusted", title=f"{found.verdict}: {names}")
    for one in found.ranking[:MOST_RANKED]:
        weight = "" if one.evidence is None else f"{one.evidence.weight:.3f}"
        size = "" if one.evidence is None else amplitude(one.evidence.effect) + " at its bound" * one.evidence.at_bound
        table.add_row(one.kind, weight, size, f"{one.adjusted_p_value:.2g}")
    if found.none_of_these_weight is not None and found.announced:
        table.add_row("none of these", f"{found.none_of_these_weight:.3f}", "", "")
    _say(folder, table)
    readings = [f"{one.kind}: {one.reading}" for one in found.ranking if one.announced and one.reading]
    for text in (*readings, found.reason):
        if text:
            Console().print(text, markup=False)


def write_report(path: Path, chain: "Chain", title: str = "", introduction: str = "") -> None:
    """The report of the whole chain as one HTML file; title and introduction are those of its model unless given."""
    from app.report.chain.build import chain_report
    from app.report.page import write

    write(chain_report(chain, title, introduction), path)
    Console().print(f"report in {path}")


def _status(outcome: Any) -> str:
    return str(outcome.status) + (f" ({outcome.advice})" if outcome.advice else "")


def _write(folder: Path, name: str, document: BaseModel) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(document.model_dump_json(by_alias=True, indent=2) + "\n", encoding="utf-8")


def _say(folder: Path, table: Table) -> None:
    console = Console()
    console.print(table)
    console.print(f"written to {folder}")
