"""Triangular factors of tall matrices."""

import numpy as np

from identification.arrays import FloatArray


def triangular_factor(matrix: FloatArray) -> FloatArray:
    """R (min(rows, columns), columns) of matrix = Q R, Q never formed."""
    return np.asarray(np.linalg.qr(matrix, mode="r"), dtype=np.float64)
