"""What estimators return: a model, how the computation ended, and how far the model may be believed."""

from dataclasses import dataclass

from identification.models.model import LocalModel, Model
from identification.outcome import Outcome, TestResult
from identification.signals import Measurement


@dataclass(frozen=True, eq=False)
class LocalEstimate:
    """A local model with its outcome, tests of its residual, and its fit in % (100 (1 − ‖y − ŷ‖/‖y − ȳ‖))."""

    model: LocalModel
    outcome: Outcome
    tests: tuple[TestResult, ...]
    fit_percent: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """What a method found beside the model; `warnings`: its assumptions that the data break."""

    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Estimate:
    """A model with its outcome and tests, and what its method `found` besides.

    `local` estimates that it stands on, and what each was `fitted` to.
    """

    model: Model
    outcome: Outcome
    tests: tuple[TestResult, ...]
    local: tuple[LocalEstimate, ...] = ()
    fitted: tuple[Measurement, ...] = ()
    found: Found | None = None
