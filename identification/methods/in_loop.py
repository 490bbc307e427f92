"""What is done about records in which a controller acted, whether that was stated or only seen."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from identification.errors import MisuseError
from identification.measurements.feedback import feedback_seen
from identification.models.rational import RationalStructure
from identification.outcome import Outcome, TestResult
from identification.signals import Measurement, TimeRecord


@dataclass(frozen=True)
class Seen:
    """The records, by their places, in which feedback was found that was not stated, and the tests that say so."""

    places: tuple[int, ...]
    tests: tuple[TestResult, ...]

    def noted(self, outcome: Outcome) -> Outcome:
        """The outcome that says that these records were taken as recorded in a loop."""
        if not self.places:
            return outcome
        which = ", ".join(str(place + 1) for place in self.places)
        said = (
            f"a controller seems to have acted in experiment {which}, though no feedback was stated: it was fitted as"
            " recorded in a loop; state feedback, and the reference if it was recorded"
        )
        return replace(outcome, advice="; ".join(part for part in (outcome.advice, said) if part))


def with_feedback(structure: RationalStructure, data: Sequence[Measurement]) -> tuple[list[Measurement], Seen]:
    """The data with feedback stated where it was found (`feedback_test`, at a level of 1 in 1000 for all together)."""
    delayed = structure.n_k > 0 if structure.is_discrete else structure.n_b < structure.n_a
    given, places, tests = list(data), [], []
    for i, one in enumerate(data):
        if not isinstance(one, TimeRecord):
            continue
        known = delayed and (structure.is_discrete or one.held is not None)
        found = feedback_seen(one, known)
        if found is not None and found.p_value * len(data) < 1e-3:
            given[i] = replace(one, feedback=True)
            places.append(i)
            tests.append(replace(found, name=f"{found.name}, experiment {i + 1}"))
    return given, Seen(tuple(places), tuple(tests))


def require_judgeable(record: TimeRecord) -> None:
    """Raises MisuseError for a record in a loop, without a period, of which a frequency response is to be made.

    Smoothed over lines it is biased by the noise that the controller fed back; a periodic reference repeats the input.
    """
    if record.feedback and record.period_count < 2 and record.reference is None:
        raise MisuseError(
            "the response of this record cannot be judged, because a controller acted on the output and nothing"
            " repeats: describe the plant in discrete time (its prediction errors are then fitted), record the"
            " reference, or play a periodic one",
            "feedback",
        )
