"""The directions of θ that a response shows, where a structure has others besides."""

import numpy as np

from identification.arrays import FloatArray
from identification.models.structure import Structure
from identification.scheduling import ParameterDependence


def gauge_tangent(structure: Structure, dependence: ParameterDependence, theta: FloatArray) -> FloatArray:
    """The directions (k, g) of θ that no response shows at any p.

    What `Structure.gauge` says of ζ holds function by function, as it is linear in ζ and the same everywhere.
    """
    parts = dependence.split(theta)
    stacked = np.zeros((max(map(len, parts)), dependence.coefficient_count))
    for part, place in zip(parts, dependence.places, strict=True):
        stacked[: len(part), place] = part
    changes = structure.gauge(stacked)
    rows = (changes[: len(part), place] for part, place in zip(parts, dependence.places, strict=True))
    return np.concatenate([row.reshape(-1, changes.shape[-1]) for row in rows])


def perpendicular(tangent: FloatArray) -> FloatArray:
    """An orthonormal basis Q (k, k − g) of what is perpendicular to directions (k, g)."""
    left, _, _ = np.linalg.svd(tangent, full_matrices=True)
    return np.asarray(left[:, tangent.shape[1] :])
