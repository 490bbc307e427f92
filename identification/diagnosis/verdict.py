"""What a diagnosis comes to, and why."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from identification.comparison.batch import Batch
from identification.diagnosis.evidence import STRICT, Evidence
from identification.diagnosis.remainder import MATERIAL
from identification.extension.fit import Fit
from identification.outcome import TestResult

Verdict = Literal["nothing missing", "explained", "partly explained", "not in the library", "cannot be judged"]
PARTLY = 0.2
FEWEST = 10


@dataclass(frozen=True)
class Rest:
    """What a fit leaves: its lack of fit, and its size beyond noise relative to the output."""

    test: TestResult
    share: float

    @property
    def acceptable(self) -> bool:
        """Whether noise explains it (p of a thousandth or more) or it is too small to matter."""
        return self.test.p_value >= STRICT or self.share <= MATERIAL

    @property
    def words(self) -> str:
        """Both numbers."""
        size = f"it is {100 * self.share:.2g} % of the output beyond noise"
        if self.test.p_value >= STRICT:
            return f"noise explains what is left (p = {self.test.p_value:.2g}; {size})"
        if self.share <= MATERIAL:
            return f"{size}, below the {100 * MATERIAL:g} % that count as material (p = {self.test.p_value:.2g})"
        return f"noise does not explain what is left (p = {self.test.p_value:.2g}; {size})"


def why_not_judged(base: Fit, batches: Sequence[Batch]) -> str:
    """Why these experiments cannot say whether something is missing; empty where they can."""
    if not base.outcome.ok:
        return "the parameters could not be fitted to these experiments; start them nearer to what they are"
    left = base.rows.count - len(base.tangents)
    if not base.rows.scaled and left < FEWEST:
        return f"without variances or repeats {left} numbers more than parameters are too few to know the noise by"
    return ""


def why_not_all(batches: Sequence[Batch]) -> str:
    """Why "nothing missing" would say too much; empty where it would not."""
    if any(batch.smoothed for batch in batches):
        return (
            "effects that act on signals (friction, springs, saturation …) were not judged, as the records do not"
            " repeat; play at least two periods of a periodic signal"
        )
    return ""


def judged(before: Rest, after: Rest, announced: Sequence[Evidence], cannot: str, not_all: str) -> tuple[Verdict, str]:
    """The verdict with its reason: `before` is what the model leaves, `after` what it leaves with the best effect."""
    if cannot:
        return "cannot be judged", cannot
    if not announced:
        if not before.acceptable:
            return "not in the library", before.words
        return ("cannot be judged", f"{before.words}, but {not_all}") if not_all else ("nothing missing", before.words)
    best = announced[0]
    if after.acceptable and not best.at_bound:
        return "explained", after.words
    if after.acceptable:
        return "partly explained", f"{after.words}, but its value is held by the end of its physical range"
    return "partly explained", f"{after.words}; the best effect takes away {100 * best.share:.0f} % of what was missing"
