"""What was measured and what the model answers to the same input, as frequency responses for pictures."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.batch import EXCITED, Batch


@dataclass(frozen=True, eq=False)
class ComparedResponses:
    """Y/U and Ŷ/U (M, K) of one grid at the excited lines that are compared, `shown`; zero elsewhere.

    `deviation` (M, K) the root of E|n|²/|U|², None where the size of the noise is not known. A model with effects that
    act on signals answers to this very input, so that Ŷ/U is no property of the model alone.
    """

    measured: ComplexArray
    modelled: ComplexArray
    deviation: FloatArray | None
    shown: BoolArray


def compared_responses(batch: Batch, modelled: ComplexArray) -> ComparedResponses:
    """The responses of a batch and of a model whose outputs are (M, K)."""
    shown = (batch.classes == EXCITED) & np.isfinite(batch.variances) & (batch.inputs != 0)
    inputs = np.where(shown, batch.inputs, 1.0)
    deviation = np.sqrt(np.where(shown, batch.variances, 0.0)) / abs(inputs) if batch.scaled else None
    return ComparedResponses(
        np.where(shown, batch.outputs / inputs, 0.0), np.where(shown, modelled / inputs, 0.0), deviation, shown
    )
