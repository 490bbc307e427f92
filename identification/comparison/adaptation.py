"""What of a batch follows from the model that it is held against: weights, transients, noise on the input."""

from abc import ABC, abstractmethod
from typing import Any, Self

from identification.arrays import ComplexArray


class Adaptation(ABC):
    """How a batch is rebuilt under a model; `identification.extension.settle` alternates it with the fit.

    A batch holds its adaptation, and the signals of a model (`Flow`) hold the batch: neither is named here.
    """

    @abstractmethod
    def settled(self, batch: Any, flow: Any) -> Any:
        """The batch, measured data unchanged, with what follows from the signals of a model."""

    @abstractmethod
    def measured_law(self, batch: Any) -> ComplexArray | None:
        """The measured output (M, K) where a controller ran, from which forces that are fed back may be computed."""

    @abstractmethod
    def joined(self, others: "list[Self]") -> Self:
        """That of the batch in which the records of several stand together, the own ones first."""
