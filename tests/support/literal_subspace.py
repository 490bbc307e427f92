"""Algorithm 2 of [Akcay2008] word for word: powers of z, a dense QR factorisation, loops over lines. Discrete time."""

import numpy as np

from identification.models.system import StateSpace


def block_vandermonde(z, blocks):
    """[X_1 … X_M; z_1 X_1 …; …]/√M for blocks X_k (F, p, m), q of them."""
    stacked, powers = blocks

    def column(k):
        return np.concatenate([z[k] ** i * stacked[k] for i in range(powers)])

    return np.concatenate([column(k) for k in range(len(z))], axis=1) / np.sqrt(len(z))


def literal_observability(omega, response, sample_time, block_rows, variance=None):
    """K U (qp, qp) and the singular values of K⁻¹ R_22, for G (F, p, m); K from `variance` (F,), or K = I."""
    count, p, m = response.shape
    z = np.exp(1j * omega * sample_time)
    G = block_vandermonde(z, (response, block_rows))
    W = block_vandermonde(z, (np.tile(np.eye(m), (count, 1, 1)), block_rows))
    stacked = np.block([[W.real, W.imag], [G.real, G.imag]])
    r = np.linalg.qr(stacked.T)[1].T
    r22 = r[block_rows * m :, block_rows * m :]
    K = np.eye(block_rows * p)
    if variance is not None:
        Wp = block_vandermonde(z, (np.sqrt(variance)[:, None, None] * np.eye(p), block_rows))
        K = np.linalg.cholesky(np.real(Wp @ Wp.conj().T))
    left, sizes, _ = np.linalg.svd(np.linalg.solve(K, r22))
    return K @ left, sizes


def literal_subspace(omega, response, sample_time, order, block_rows, variance=None):
    """The model of order n."""
    count, p, _ = response.shape
    z = np.exp(1j * omega * sample_time)
    o = literal_observability(omega, response, sample_time, block_rows, variance)[0][:, :order]
    a, c = np.linalg.lstsq(o[:-p], o[p:])[0], o[:p]
    weights = np.ones(count) if variance is None else 1 / np.sqrt(variance)
    rows, right = [], []
    for k in range(count):
        x = np.concatenate([c @ np.linalg.inv(z[k] * np.eye(order) - a), np.eye(p)], axis=1)
        rows += [weights[k] * x.real, weights[k] * x.imag]
        right += [weights[k] * response[k].real, weights[k] * response[k].imag]
    bd = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right))[0]
    return StateSpace(a, bd[:order], c, bd[order:], sample_time)
