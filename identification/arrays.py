"""The array types that all packages use."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from identification.errors import RangeError

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]


def finite_floats(values: ArrayLike, field: str) -> FloatArray:
    """A read-only copy of `values` as doubles; raises RangeError when one of them is not a finite number."""
    return _frozen(np.array(values, dtype=np.float64), field)


def require_positive(value: float, name: str) -> None:
    """Raises RangeError unless the value is a positive number; the field is the name with underscores."""
    if not (np.isfinite(value) and value > 0):
        raise RangeError(f"the {name} is {value}; it must be positive", name.replace(" ", "_"))


def finite_complex(values: ArrayLike, field: str) -> ComplexArray:
    """A read-only copy of `values` as complex doubles; raises RangeError when one of them is not finite."""
    return _frozen(np.array(values, dtype=np.complex128), field)


def _frozen(array: NDArray[Any], field: str) -> NDArray[Any]:
    bad = np.argwhere(~np.isfinite(array))
    if bad.size:
        position = ", ".join(str(i) for i in bad[0])
        raise RangeError(
            f"{field}: the value at position {position} is not a finite number; remove or repair it", field
        )
    array.setflags(write=False)
    return array
