"""Effects of the recorder: when it takes its samples."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.places.place import Effect


@dataclass(frozen=True)
class Recorder(Effect):
    """Shows the output otherwise than it is, by a linear operation that depends on when the record began."""

    place: ClassVar[str] = "recorder"
    needs_records: ClassVar[bool] = True
    of_measurements: ClassVar[bool] = True

    @abstractmethod
    def recorded(self, e: FloatArray, lines: ComplexArray, batch: Batch) -> ComplexArray:
        """What is recorded (…, M, K) of an output with lines (…, M, K), for e (M,)."""
