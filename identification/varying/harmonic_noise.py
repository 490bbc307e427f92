"""The covariance of output noise on the harmonics, from the lines between them."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.varying.records import SteadyPeriods

LEAST_LINES = 30


@dataclass(frozen=True, eq=False)
class HarmonicNoise:
    """`covariance` (P, n_y, n_y) of the mean period's spectrum at every line, with ν = `degrees_of_freedom`."""

    covariance: ComplexArray
    degrees_of_freedom: int


def harmonic_noise(steady: SteadyPeriods) -> HarmonicNoise:
    """Covariance of Ȳ_k, the discrete Fourier transform of the mean of N_p periods [Goos2014, Section 3.2].

        Ĉ_k = (1 / ν N_p²) Σ_l Y_l Y_l*,   over the ν lines of the whole record nearest to k N_p that are no harmonics

    A periodic plant answers on the harmonics only, so what is between them is noise, white or coloured; it is taken to
    change little over the window, which holds N_p − 1 lines, or as many spans between harmonics as give thirty lines
    for every output. Near 0 and P/2 the window holds lines with their mirror images, so half the degrees of freedom.
    Noise below rounding errors is set to those. Raises MisuseError when the record is too short for such a window.
    """
    periods, period, n_y = steady.output.shape
    spans = -(-LEAST_LINES * n_y // (periods - 1))
    if spans > period // 2:
        raise MisuseError(
            f"{periods} steady periods of {period} samples leave too few lines between the harmonics to estimate the"
            " noise; record more periods",
            "period",
        )
    spectrum = np.fft.fft(steady.output.reshape(periods * period, n_y), axis=0) / periods
    products = spectrum[:, :, None] * spectrum[:, None, :].conj()
    products[::periods] = 0
    half = spans * periods // 2
    wrapped = np.concatenate([products[len(products) - half :], products, products[: half + 1]])
    total = np.concatenate([np.zeros((1, n_y, n_y)), np.cumsum(wrapped, axis=0)])
    starts = periods * np.arange(period)
    count = 2 * half + 1 - (2 * (half // periods) + 1)
    covariance = (total[starts + 2 * half + 1] - total[starts]) / count
    return HarmonicNoise(_above_rounding(covariance, spectrum[::periods]), count)


def _above_rounding(covariance: ComplexArray, spectrum: ComplexArray) -> ComplexArray:
    level = np.mean(abs(spectrum) ** 2, axis=0)
    floor = np.maximum(1e6 * np.finfo(np.float64).eps ** 2 * level, np.finfo(np.float64).tiny)
    hermitian = (covariance + covariance.conj().transpose(0, 2, 1)) / 2
    return np.asarray(hermitian + np.eye(len(floor)) * floor)


@dataclass(frozen=True, eq=False)
class Whitening:
    """Deviations at lines k as real numbers of unit variance, (√2 Re, √2 Im) L_k⁻¹ e_k with C_k = L_k L_k*.

    At the `real` lines (0 and P/2) e is real and L⁻¹ e taken as it is.
    """

    factor: ComplexArray
    real: BoolArray

    @classmethod
    def of(cls, covariance: ComplexArray, real: BoolArray) -> "Whitening":
        """From the covariances (F, n_y, n_y) at the lines."""
        lower = np.linalg.cholesky(np.where(real[:, None, None], covariance.real, covariance))
        scale = np.where(real, 1.0, np.sqrt(2.0))[:, None, None]
        return cls(np.asarray(np.linalg.inv(lower) * scale), real)

    def __call__(self, deviations: ComplexArray) -> FloatArray:
        """(F, n_y, columns) as (rows, columns)."""
        white = deviations * self.factor if self.factor.shape[1] == 1 else self.factor @ deviations
        columns = white.shape[2]
        parts = (white.real.reshape(-1, columns), white.imag[~self.real].reshape(-1, columns))
        return np.concatenate(parts)
