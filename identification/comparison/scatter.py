"""Whether the noise of a periodic record is larger where its output changes fast, as of instants that scatter."""

import numpy as np

from identification.arrays import ComplexArray, FloatArray


def scatter_with_rate(y: ComplexArray, noise: FloatArray, sample_time: float) -> FloatArray:
    """τ̂² and its deviation where there is none (2,), in s², from spectra Y (P, K), X = rfft(x)/L, of P periods.

        E d_p(t)² = σ² + τ² ẏ(t)²,   τ̂² = Σ_t (v(t) − v̄) (ẏ(t)² − mean)/Σ_t (ẏ(t)² − mean)²

    d what periods differ by but for a straight line over them, v(t) its mean square, P − 2 numbers for each t. The
    deviation is that of Gaussian noise with the spectrum `noise` (K,). An infinite one for fewer than three periods.
    """
    count, lines = y.shape
    length = 2 * (lines - 1)
    if count < 3 or lines < 3:
        return np.array([0.0, np.inf])
    place = np.arange(count) - (count - 1) / 2
    away = y - y.mean(axis=0)
    away = away - np.multiply.outer(place, place @ away) / np.sum(place**2)
    square = np.sum(np.fft.irfft(away * length, n=length) ** 2, axis=0) / (count - 2)
    omega = 2 * np.pi * np.arange(lines) / (length * sample_time)
    omega[-1] = 0.0
    fast = np.fft.irfft(1j * omega * y.mean(axis=0) * length, n=length) ** 2
    fast = fast - fast.mean()
    size = float(np.sum(fast**2))
    if size == 0:
        return np.array([0.0, np.inf])
    inner = noise[1:-1]
    together = len(inner) * float(np.sum(inner**2)) / float(np.sum(inner)) ** 2
    deviation = square.mean() * np.sqrt(2 / (count - 2) * together / size)
    return np.array([float(np.sum(square * fast)) / size, float(deviation)])
