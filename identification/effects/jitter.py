"""Sampling instants that scatter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from scipy.special import ndtr

from identification.places.place import Flow
from identification.places.variance import VarianceEffect


@dataclass(frozen=True)
class Jitter(VarianceEffect):
    """y(t + n_t), n_t random of deviation τ: noise of variance τ² ẏ(t)², larger where the output changes fast.

    Seen in the squares of what the periods of a record differ by (`comparison.scatter`), the records together weighed
    by their deviations [PintelonSchoukens2012, Section 2.4].
    """

    kind: ClassVar[str] = "jitter"
    title: ClassVar[str] = "sampling instants that scatter"
    unit: ClassVar[str] = "s"
    source: ClassVar[str] = "[PintelonSchoukens2012, Section 2.4]"
    of_periods: ClassVar[bool] = True
    direct: ClassVar[bool] = True
    advice: ClassVar[str] = "let a clock of the hardware trigger the samples; as noise it is allowed for"

    def variants(self, flow: Flow) -> list[Self]:
        """Itself."""
        return [self]

    def seen(self, flows: Sequence[Flow]) -> tuple[float, float] | None:
        """τ̂ and the p-value of τ = 0, one-sided; None without three periods."""
        every = [flow.batch.scatter for flow in flows if flow.batch.scatter is not None]
        found = np.concatenate(every) if every else np.zeros((0, 2))
        found = found[np.isfinite(found[:, 1]) & (found[:, 1] > 0)]
        if not len(found):
            return None
        weights = 1 / found[:, 1] ** 2
        square = float(weights @ found[:, 0] / weights.sum())
        return float(np.sqrt(max(square, 0.0))), float(ndtr(-square * np.sqrt(weights.sum())))
