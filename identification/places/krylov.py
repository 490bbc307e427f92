"""Linear equations of which only products are known, one for each record."""

from collections.abc import Callable

import numpy as np

from identification.arrays import ComplexArray, FloatArray

RIDGE = 1e-14
Product = Callable[[ComplexArray], ComplexArray]


def gmres(product: Product, nearly: Product, wanted: ComplexArray, tolerance: float, limit: int) -> ComplexArray:
    """X (M, K) with product(X) = wanted, each row to `tolerance` of ‖wanted‖ or as near as `limit` products bring it.

    Real-linear in real and imaginary parts. GMRES with the right preconditioner `nearly`, all rows side by side
    [Saad2003, Algorithm 9.5].
    """
    size = _norm(wanted)
    basis = [wanted / np.where(size > 0, size, 1.0)[:, None]]
    images: list[ComplexArray] = []
    hessenberg = np.zeros((len(wanted), limit + 1, limit))
    weights = np.zeros((len(wanted), 0))
    for j in range(limit):
        images.append(nearly(basis[j]))
        vector = product(images[j])
        for i in range(j + 1):
            overlap = np.sum((basis[i].conj() * vector).real, axis=1)
            hessenberg[:, i, j] = overlap
            vector = vector - overlap[:, None] * basis[i]
        length = _norm(vector)
        hessenberg[:, j + 1, j] = length
        basis.append(vector / np.where(length > 0, length, 1.0)[:, None])
        weights, left = _least(hessenberg[:, : j + 2, : j + 1], size)
        if np.all(left <= tolerance * size):
            break
    return np.asarray(sum(weights[:, i, None] * one for i, one in enumerate(images)))


def _norm(x: ComplexArray) -> FloatArray:
    return np.asarray(np.linalg.norm(x, axis=1))


def _least(matrix: FloatArray, size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The weights (M, j) that make ‖size e₁ − matrix · weights‖ least, and what is left of it (M,)."""
    gram = np.swapaxes(matrix, 1, 2) @ matrix
    ridge = RIDGE * np.trace(gram, axis1=1, axis2=2)[:, None, None] + np.finfo(float).tiny
    target = size[:, None] * matrix[:, 0]
    weights = np.linalg.solve(gram + ridge * np.eye(gram.shape[1]), target[..., None])[..., 0]
    left = -(matrix @ weights[..., None])[..., 0]
    left[:, 0] += size
    return weights, np.linalg.norm(left, axis=1)
