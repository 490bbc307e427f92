"""Local models as transfer functions of python-control, and back."""

from typing import TYPE_CHECKING

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, RangeError
from identification.models.rational import RationalStructure

if TYPE_CHECKING:
    import control


def to_transfer_function(structure: RationalStructure, zeta: FloatArray) -> "control.TransferFunction":
    """G = B/A of ζ (n,) as a transfer function in z (with its sample time) or in s (in rad/s); needs python-control.

    Raises MisuseError for a model with an estimated delay, which is no rational function.
    """
    import control

    if structure.delay:
        raise MisuseError("a model with a delay is no rational function; approximate the delay first", "structure")
    a, b, *_ = structure.split(zeta)
    denominator = np.concatenate([[1.0], a])
    if structure.sample_time is None:
        return control.TransferFunction(_powers_of_s(b, structure), _powers_of_s(denominator, structure))
    numerator = np.concatenate([np.zeros(structure.n_k), b])
    length = max(len(numerator), len(denominator))
    padded = [np.pad(part, (0, length - len(part))) for part in (numerator, denominator)]
    return control.TransferFunction(padded[0], padded[1], structure.sample_time)


def from_transfer_function(system: "control.TransferFunction") -> tuple[RationalStructure, FloatArray]:
    """The structure and ζ of a proper transfer function with one input and one output; H = 1.

    Raises MisuseError for several inputs or outputs and for discrete time without a sample time, RangeError for a
    numerator of higher degree than the denominator in discrete time.
    """
    if (system.ninputs, system.noutputs) != (1, 1) or system.dt is True:
        raise MisuseError("give a transfer function with one input, one output and a stated sample time", "system")
    numerator = np.trim_zeros(np.atleast_1d(np.asarray(system.num[0][0], dtype=np.float64)), "f")
    denominator = np.trim_zeros(np.atleast_1d(np.asarray(system.den[0][0], dtype=np.float64)), "f")
    n_a = len(denominator) - 1
    numerator = (numerator if len(numerator) else np.zeros(1)) / denominator[0]
    zeta_a = denominator[1:] / denominator[0]
    if not system.dt:
        return RationalStructure(n_a, len(numerator) - 1), np.concatenate([zeta_a, numerator])
    n_k = n_a - (len(numerator) - 1)
    if n_k < 0:
        raise RangeError("the numerator has a higher degree than the denominator; such a system looks ahead", "system")
    return RationalStructure(n_a, len(numerator) - 1, n_k, sample_time=system.dt), np.concatenate([zeta_a, numerator])


def _powers_of_s(coefficients: FloatArray, structure: RationalStructure) -> FloatArray:
    """Coefficients of powers of x = s/frequency_scale as coefficients of powers of s, highest first."""
    powers = np.arange(len(coefficients))[::-1]
    return np.asarray(coefficients / structure.frequency_scale**powers)
