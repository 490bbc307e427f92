"""Anderson's mixing of the steps of a repetition."""

import numpy as np

from identification.arrays import ComplexArray


def mixed(steps: list[ComplexArray], values: list[ComplexArray]) -> ComplexArray:
    """Σ α_i values_i with Σ α_i = 1 that makes ‖Σ α_i steps_i‖ least, in each row."""
    if len(steps) == 1:
        return values[0]
    last = steps[-1]
    changes = np.stack([last - other for other in steps[:-1]], axis=1)
    gram = np.einsum("mik,mjk->mij", changes.conj(), changes).real
    target = np.einsum("mik,mk->mi", changes.conj(), last).real
    ridge = 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] + np.finfo(float).tiny
    weights = np.linalg.solve(gram + ridge * np.eye(len(steps) - 1), target[..., None])[..., 0]
    offsets = np.stack([values[-1] - other for other in values[:-1]], axis=1)
    return np.asarray(values[-1] - np.einsum("mi,mik->mk", weights, offsets))
