"""x(t+1) = F(t) x(t) + w(t), for many models and without a loop over single samples."""

import numpy as np

from identification.arrays import FloatArray


def propagate(transition: FloatArray, forcing: FloatArray, start: FloatArray) -> FloatArray:
    """x(0) … x(N) (..., N + 1, n) of x(t+1) = F(t) x(t) + w(t), F (..., N, n, n), w (..., N, n), x(0) (..., n).

    The time axis is cut into √N parts that run side by side, once from rest and once as transition matrices; then the
    parts are joined: x at the end of a part is Φ x at its beginning + its response from rest.
    """
    count, n = forcing.shape[-2:]
    batch = np.broadcast_shapes(transition.shape[:-3], forcing.shape[:-2], start.shape[:-1])
    length = int(np.ceil(np.sqrt(count)))
    parts = -(-count // length)
    pad = parts * length - count
    f = _cut(transition, 3, parts, length, pad, 0.0)
    w = _cut(forcing, 2, parts, length, pad, 0.0)
    response = np.zeros((*batch, length + 1, parts, n))
    joint = np.broadcast_to(np.eye(n), (*f.shape[:-4], parts, n, n))
    for t in range(length):
        response[..., t + 1, :, :] = (f[..., t, :, :, :] @ response[..., t, :, :, None])[..., 0] + w[..., t, :, :]
        joint = f[..., t, :, :, :] @ joint
    state = np.zeros((*batch, length + 1, parts, n))
    x = np.broadcast_to(start, (*batch, n))
    for k in range(parts):
        state[..., 0, k, :] = x
        x = (joint[..., k, :, :] @ x[..., None])[..., 0] + response[..., length, k, :]
    for t in range(length):
        state[..., t + 1, :, :] = (f[..., t, :, :, :] @ state[..., t, :, :, None])[..., 0] + w[..., t, :, :]
    inner = np.moveaxis(state[..., :-1, :, :], -3, -2).reshape(*batch, parts * length, n)
    last = state[..., count - (parts - 1) * length, parts - 1, :]
    return np.concatenate([inner[..., :count, :], last[..., None, :]], axis=-2)


def _cut(array: FloatArray, trailing: int, parts: int, length: int, pad: int, fill: float) -> FloatArray:
    """(..., N, rest) as (..., length, parts, rest), the end filled up."""
    axis = array.ndim - trailing
    widths = [(0, pad if i == axis else 0) for i in range(array.ndim)]
    padded = np.pad(array, widths, constant_values=fill)
    shape = (*array.shape[:axis], parts, length, *array.shape[axis + 1 :])
    return np.ascontiguousarray(np.moveaxis(padded.reshape(shape), axis + 1, axis))
