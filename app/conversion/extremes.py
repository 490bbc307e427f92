"""Numbers so large or small that computing with them leaves the range of doubles."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from identification.errors import RangeError
from identification.models.model import Model

Number = TypeVar("Number", np.float64, np.complex128)

logger = logging.getLogger(__name__)


@contextmanager
def within_doubles() -> Iterator[None]:
    """Turn overflow, and decompositions that it spoils, into misuse; the log keeps where it happened."""
    try:
        yield
    except (OverflowError, FloatingPointError, ZeroDivisionError, np.linalg.LinAlgError) as error:
        logger.warning("a computation left the range of numbers", exc_info=True)
        raise RangeError(
            f"the computation left the range of numbers ({error}): values of the request differ too much in size;"
            " choose units in which they lie nearer to one"
        ) from error


def require_finite(model: Model) -> None:
    """Raises RangeError when an estimate has parameters that are no numbers."""
    if not (np.isfinite(model.theta).all() and np.isfinite(model.noise_variance)):
        raise RangeError("the estimate has no finite parameters; choose units in which the data lie nearer to one")


def finite(values: NDArray[Number], what: str) -> NDArray[Number]:
    """The values themselves; raises RangeError unless all are finite."""
    if not np.isfinite(values).all():
        raise RangeError(
            f"the {what} leave the range of numbers somewhere; choose units in which they lie nearer to one"
        )
    return values
