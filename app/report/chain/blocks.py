"""What comparisons and diagnoses look like, wherever they come from."""

from collections.abc import Mapping, Sequence

from app.report.axes import Axes
from app.report.document import Plot, Table
from app.report.figures.effects import confusability, ranking, visibility
from app.report.figures.misfit import misfit_by_band, misfit_by_class, misfit_by_point, overall_table
from app.report.figures.misfit_map import MapRow, misfit_map
from app.report.figures.missing import missing
from app.report.numbers import percent, significant
from app.schemas.comparisons import ComparisonPart
from app.schemas.diagnoses import Diagnosis

RESIDUALS = "Residuals divided by their standard deviation: noise, and off the fitted data the model's own uncertainty."
VERDICTS = {
    "nothingMissing": "Nothing is missing that these experiments could show.",
    "explained": "The best effect explains it.",
    "partlyExplained": "The best effect explains a part; something else is missing too.",
    "notInTheLibrary": "Something is missing, and no effect of the library has its shape.",
    "cannotBeJudged": "These experiments cannot say whether something is missing.",
}


def comparison_blocks(rows: Sequence[MapRow], parts: Sequence[ComparisonPart], axes: Axes) -> list[Plot | Table]:
    """The map, and the lack of fit by place where the size of the noise is known."""
    blocks: list[Plot | Table] = [misfit_map(rows)]
    if any(part.lack_of_fit for part in parts):
        blocks += [overall_table(parts), misfit_by_point(parts, axes), misfit_by_band(parts), misfit_by_class(parts)]
    return blocks


def diagnosis_text(diagnosis: Diagnosis) -> str:
    """What was found, in words."""
    titles = {one.kind: one.title for one in diagnosis.ranking}
    names = ", ".join(titles.get(kind, kind) for kind in diagnosis.announced)
    reason = f" {diagnosis.reason[0].upper()}{diagnosis.reason[1:]}." if diagnosis.reason else ""
    for one in diagnosis.variations:
        reason += (
            "" if one.explains else f" Found too: {one.title} ({significant(one.size)}, {one.unit}); {one.advice}."
        )
    if not names:
        return VERDICTS[diagnosis.verdict] + reason
    held = diagnosis.ranking[0].evidence is not None and diagnosis.ranking[0].evidence.at_bound
    names += " (at the end of its physical range)" if held else ""
    share = percent(diagnosis.explained_share)
    reading = next((f" That is: {one.reading}." for one in diagnosis.ranking if one.announced and one.reading), "")
    return f"Announced: {names}.{reading} {VERDICTS[diagnosis.verdict]} The best effect explains {share} of it.{reason}"


def diagnosis_blocks(diagnosis: Diagnosis, labels: Mapping[str, str], axes: Axes) -> list[Plot | Table]:
    """Ranking, what is missing, what cannot be told apart, what could be seen; each where there is any."""
    blocks: list[Plot | Table] = []
    if any(one.evidence for one in diagnosis.ranking):
        blocks.append(ranking(diagnosis))
    if diagnosis.missing:
        blocks.append(missing(diagnosis, labels, axes))
    if len(diagnosis.ranking) > 1:
        blocks.append(confusability(diagnosis))
    if diagnosis.visibility:
        blocks.append(visibility(diagnosis.visibility))
    return blocks
