"""Tables of the demonstration that the terminal and the report share."""

from app.demo import task
from app.report.document import Table
from app.report.numbers import estimate, percent, probability, significant, weight
from app.schemas.comparisons import Comparison
from app.schemas.diagnoses import Diagnosis
from app.schemas.models import Model


def asked_table() -> Table:
    """Parameters and the standard deviations asked for."""
    parts = zip(task.PARAMETERS, task.MEANINGS, task.ASKED, strict=True)
    rows = tuple((name, meaning, significant(sigma)) for name, meaning, sigma in parts)
    return Table(("parameter", "what it is", "σ asked"), rows, text_columns=2)


def estimate_table(model: Model) -> Table:
    """θ̂ with standard deviations, how far these are from what was asked, and how far θ̂ is from the truth."""
    deviations = model.standard_deviations or []
    truth = task.true_parameters()
    parts = zip(task.PARAMETERS, model.theta, deviations, task.ASKED, truth, strict=True)
    rows = tuple(
        (name, estimate(value, sigma), percent(sigma / asked), f"{significant(abs(value - true) / sigma, 2)} σ")
        for name, value, sigma, asked, true in parts
    )
    return Table(("parameter", "estimate ± σ", "of σ asked", "actual error"), rows)


def test_table(comparison: Comparison) -> Table:
    """Lack of fit on fitted and held-out data."""
    tests = [(part.data, part.lack_of_fit) for part in comparison.parts if part.lack_of_fit is not None]
    rows = tuple(
        (
            "held out" if data == "heldOut" else "fitted",
            significant(test.statistic or 0.0, 4),
            significant(test.degrees_of_freedom or 0.0, 4),
            probability(test.p_value or 0.0),
        )
        for data, test in tests
    )
    return Table(("data", "misfit χ²", "expected", "p-value"), rows)


def effects_table(diagnosis: Diagnosis, most: int = 5) -> Table:
    """The effects with most evidence."""
    best = [one for one in diagnosis.ranking if one.evidence is not None][:most]
    rows = tuple(
        (
            one.title,
            "announced" if one.announced else "",
            weight(one.evidence.weight),
            significant(one.evidence.chi_square_explained, 4),
        )
        for one in best
        if one.evidence is not None
    )
    return Table(("effect", "", "weight", "misfit χ² explained"), rows, text_columns=2)
