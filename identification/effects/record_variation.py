"""A parameter of the plant that is another in every record."""

from dataclasses import dataclass
from typing import ClassVar

from identification.places.variance import ParameterSpread


@dataclass(frozen=True)
class RecordVariation(ParameterSpread):
    """ζ_i (1 + τ n_m) in the m-th record, n_m random: a temperature, a wear, a load that was not logged.

    Judged by how records at one operating point differ [Searle1992, Section 3.1].
    """

    kind: ClassVar[str] = "record_variation"
    title: ClassVar[str] = "variation from record to record"
    source: ClassVar[str] = "[Searle1992, Section 3.1]"
    within_points: ClassVar[bool] = True
    advice: ClassVar[str] = (
        "log with every experiment what may have changed (temperature, supply, load, age), so that it can be asked"
        " whether the plant depends on it"
    )
