"""The figures of comparisons, diagnoses and staircases that were made with the library, without the service."""

from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from app.conversion.comparisons import part_document
from app.conversion.diagnoses import findings
from app.report.axes import Axes
from app.report.chain.blocks import RESIDUALS, comparison_blocks, diagnosis_blocks, diagnosis_text
from app.report.document import Section
from app.report.figures.misfit_map import MapRow
from app.report.figures.staircase import Step as Stair
from app.report.figures.staircase import staircase as staircase_plot
from app.schemas.diagnoses import Diagnosis as DiagnosisDocument
from app.schemas.experiments import Experiment
from identification.comparison.batch import Batch
from identification.comparison.compare import Comparison
from identification.diagnosis.diagnose import Diagnosis
from identification.diagnosis.staircase import Step
from identification.signals import Measurement


def comparison_section(
    title: str,
    found: Comparison,
    batches: Sequence[Batch],
    measured: Sequence[Measurement],
    axes: Axes,
    held_out: bool = False,
) -> Section:
    """Where a model fails: what `compare` found of the batches that were gathered from the measurements."""
    known = _experiments(measured, axes)
    part = part_document("heldOut" if held_out else "fitted", found, batches, known)
    rows: dict[int, MapRow] = {}
    for one in found.maps:
        for m, member in enumerate(one.members):
            used = one.compared[m]
            own = (one.frequencies[used], one.residual[m, used], one.classes[m, used])
            rows[int(member)] = MapRow(known[int(member)].name, held_out, *own)
    ordered = [rows[i] for i in sorted(rows)]
    return Section(title, (RESIDUALS,), tuple(comparison_blocks(ordered, [part], axes)))


def diagnosis_section(title: str, found: Diagnosis, measured: Sequence[Measurement], axes: Axes) -> Section:
    """What a model lacks: what `diagnose` found in the measurements."""
    known = _experiments(measured, axes)
    long_ago = datetime.fromtimestamp(0, UTC)
    traced = {"id": "", "createdAt": long_ago, "softwareVersion": "", "plantId": "", "jobId": None}
    traced |= {"name": "", "description": "", "modelId": "", "comparisonId": None, "experimentIds": []}
    asked = {"amplitudeDegree": 0, "meanValue": True, "seed": 0}
    document = DiagnosisDocument.model_validate({**traced, **asked, **findings(found, known)})
    blocks = diagnosis_blocks(document, {one.id: one.name for one in known}, axes)
    return Section(title, (diagnosis_text(document),), tuple(blocks))


def staircase_section(title: str, steps: Sequence[Step]) -> Section:
    """How the error fell: the steps of `staircase`."""
    stairs: list[Stair] = []
    for step in steps:
        effects = step.model.effects
        name = f"with {effects[-1].effect.title}" if len(stairs) else "as it was"
        stairs.append(Stair(name, step.error, step.held_out_error, step.diagnosis.lack_of_fit.p_value))
    return Section(title, (), (staircase_plot(stairs),))


def _experiments(measured: Sequence[Measurement], axes: Axes) -> list[Experiment]:
    """Names and places of the measurements, as far as figures need them."""
    return [_experiment(i, one, axes) for i, one in enumerate(measured)]


def _experiment(place: int, one: Measurement, axes: Axes) -> Experiment:
    point = one.operating_point
    known: dict[str, Any] = {"id": str(place), "name": f"{place + 1}: {axes.point(point)}"}
    return Experiment.model_construct(**known, operating_point=list(point))
