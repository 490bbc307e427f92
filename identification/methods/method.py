"""What every way from data to a model says of itself, is told, and answers."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self, cast

from identification.errors import MisuseError
from identification.estimates import Estimate
from identification.models.model import Model
from identification.models.structure import Structure
from identification.scheduling import ParameterDependence
from identification.signals import FrequencyResponse, TimeRecord
from identification.varying.progress import Progress
from identification.varying.records import VaryingRecord

Data = TimeRecord | FrequencyResponse | VaryingRecord
NAMES = {
    TimeRecord: "records at operating points held still",
    FrequencyResponse: "frequency responses",
    VaryingRecord: "records along p(t)",
}


@dataclass(frozen=True, eq=False)
class Task:
    """Data, and the model that is asked for; `start` to begin the search with, `prior` an estimate from other data."""

    data: tuple[Data, ...]
    structure: Structure
    dependence: ParameterDependence
    start: Model | None = None
    prior: Model | None = None

    def has_only(self, *kinds: type[Data]) -> bool:
        """Whether all data are of these kinds."""
        return all(isinstance(one, kinds) for one in self.data)


@dataclass(frozen=True)
class Takes:
    """The kinds of data and structures of a method, and whether it takes a start and a prior estimate."""

    data: tuple[type[Data], ...]
    structures: tuple[type[Structure], ...]
    start: bool = False
    prior: bool = False

    def __str__(self) -> str:
        data, structures = (NAMES[kind] for kind in self.data), (one.__name__ for one in self.structures)
        return f"takes {' and '.join(data)} for a {' or '.join(structures)}"

    def has(self, task: Task) -> bool:
        """Whether data and structure are of these kinds."""
        return task.has_only(*self.data) and isinstance(task.structure, self.structures)


class Method(ABC):
    """A way from data to a model; its fields are its options."""

    kind: ClassVar[str]
    takes: ClassVar[Takes]

    @classmethod
    def usual(cls, task: Task) -> Self:
        """With the options that suit a task which it takes."""
        return cls()

    def refuses(self, task: Task) -> str | None:
        """Why a task that `takes` admits is not for this method, and what to give instead; None when it is."""
        return None

    @abstractmethod
    def estimate(self, task: Task, progress: Progress) -> Estimate:
        """The model of a task that it takes."""

    def check(self, task: Task) -> None:
        """Raises MisuseError, which names the argument, unless this method takes the task."""
        takes = self.takes
        if not task.has_only(*takes.data):
            raise MisuseError(f"{self.kind} {takes}; give those, or another method", "data")
        if not takes.has(task):
            raise MisuseError(f"{self.kind} {takes}; give one, or another method", "structure")
        for name in ("start", "prior"):
            if getattr(task, name) is not None and not getattr(takes, name):
                raise MisuseError(f"{self.kind} takes no {name}; leave it out, or choose another method", name)
        reason = self.refuses(task)
        if reason is not None:
            raise MisuseError(f"{self.kind}: {reason}", "data")


def held_still(task: Task) -> Sequence[TimeRecord | FrequencyResponse]:
    """The data of a task that has only such."""
    return cast(Sequence[TimeRecord | FrequencyResponse], task.data)
