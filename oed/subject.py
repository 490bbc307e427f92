"""All that experiments are to tell: about the model itself, and for every decision about a hypothesis of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import block_diag

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.models.model import Model
from oed.hypothesis import Hypothesis
from oed.information import CONTINUOUS_GRID, circle, cosine_moments, sensitivity_moments


@dataclass(frozen=True, eq=False)
class Subject:
    """Hypotheses, the first of them the model as it is; their parameters stand one after another.

    Every hypothesis has parameters θ_G of its own, so that information about all of them is block diagonal.
    """

    hypotheses: tuple[Hypothesis, ...]

    @classmethod
    def of(cls, model: Model) -> "Subject":
        """A model by itself."""
        return cls((Hypothesis(model),))

    @property
    def model(self) -> Model:
        """The model as it is."""
        return self.hypotheses[0].model

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """Where the parameters of each hypothesis stand."""
        ends = np.cumsum([0, *(one.size for one in self.hypotheses)]).tolist()
        return tuple(slice(start, end) for start, end in pairwise(ends))

    @property
    def size(self) -> int:
        """Number of parameters of all hypotheses."""
        return int(self.slices[-1].stop)

    @cached_property
    def mask(self) -> FloatArray:
        """One within the blocks of the hypotheses, zero between them."""
        return np.asarray(block_diag(*(np.ones((one.size, one.size)) for one in self.hypotheses)))

    def sensitivity(self, points: ArrayLike, omega: FloatArray) -> ComplexArray:
        """a (M, F, size); the information of one unit of energy is Re(a a*) within the blocks."""
        return np.concatenate([one.sensitivity(points, omega) for one in self.hypotheses], axis=-1)

    def moments(self, points: ArrayLike, degree: int, sample_time: float) -> FloatArray:
        """(1/2π) ∫ Re(a a*) cos(iΩ) dΩ within the blocks, (M, degree + 1, size, size)."""
        parts = [_moments(one, points, degree, sample_time) for one in self.hypotheses]
        if len(parts) == 1:
            return parts[0]
        result = np.zeros((*parts[0].shape[:2], self.size, self.size))
        for part, place in zip(parts, self.slices, strict=True):
            result[..., place, place] = part
        return result

    def by_record(self, batch: Batch) -> FloatArray:
        """The information of each record of a batch, (M, size, size)."""
        result = np.zeros((len(batch.points), self.size, self.size))
        for one, place in zip(self.hypotheses, self.slices, strict=True):
            result[:, place, place] = one.by_record(batch)
        return result

    def information(self, batches: Sequence[Batch]) -> FloatArray:
        """The information of experiments that were done, (size, size)."""
        return np.asarray(sum(self.by_record(batch).sum(axis=0) for batch in batches))


def _moments(one: Hypothesis, points: ArrayLike, degree: int, sample_time: float) -> FloatArray:
    if not one.effects:
        return sensitivity_moments(one.model, points, degree, sample_time)
    grid = circle(one.model, points, max(degree, CONTINUOUS_GRID), sample_time)
    parts = (one.sensitivity(point[None], grid) for point in one.model.dependence.points(points))
    return np.concatenate([cosine_moments(part, degree) for part in parts])
