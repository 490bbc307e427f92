"""Tables of the demonstration that the terminal and the report share."""

from app.demo import task
from app.report.document import Table
from app.report.numbers import estimate, percent, significant
from identification.estimates import LpvEstimate

UNITS = ("", "1/(m/s)", "K/kW", "K/kW/(m/s)", "", "1/(m/s)")
MEANINGS = (
    "pole, in still air",
    "pole, per m/s",
    "heating, in still air",
    "heating, per m/s",
    "draught, in still air",
    "draught, per m/s",
)


def asked_table() -> Table:
    """Parameters and the standard deviations asked for."""
    parts = zip(task.PARAMETERS, MEANINGS, task.ASKED, UNITS, strict=True)
    rows = tuple((name, meaning, f"{significant(sigma)} {unit}".strip()) for name, meaning, sigma, unit in parts)
    return Table(("parameter", "what it is", "σ asked"), rows, text_columns=2)


def estimate_table(found: LpvEstimate) -> Table:
    """θ̂ with standard deviations, and how far these are from what was asked."""
    deviations = found.model.covariance.diagonal() ** 0.5
    parts = zip(task.PARAMETERS, found.model.theta, deviations, task.ASKED, strict=True)
    rows = tuple((name, estimate(value, sigma), percent(sigma / asked)) for name, value, sigma, asked in parts)
    return Table(("parameter", "estimate ± σ", "of σ asked"), rows)
