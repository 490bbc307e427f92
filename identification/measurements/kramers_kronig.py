"""Whether an impedance can be that of a linear, causal, stable thing that did not change while it was measured."""

from dataclasses import dataclass

import numpy as np
from scipy.special import gammaincc

from identification.arrays import ComplexArray, FloatArray
from identification.errors import MisuseError
from identification.signals import FrequencyResponse

PER_DECADE = 4
BEYOND = 10.0
LEAST_FREQUENCIES = 10
LEAST_DEGREES = 6.0


@dataclass(frozen=True, eq=False)
class KramersKronig:
    """What a chain of relaxations leaves of an impedance Z (F,) at its frequencies.

    `residual`: (Z − Ẑ)/|Z|; `size`: its root mean square; `statistic`, `degrees_of_freedom`, `p_value`: of the misfit
    against the variance, None where that is not known well enough; `conjugate_size`: the size for Z*, which is much
    smaller than `size` where the imaginary part has the wrong sign.
    """

    residual: ComplexArray
    size: float
    conjugate_size: float
    statistic: float | None
    degrees_of_freedom: int
    p_value: float | None


def linear_kramers_kronig(impedance: FrequencyResponse) -> KramersKronig:
    """The linear Kramers–Kronig test: impedances that obey the relations are sums of relaxations.

        Ẑ(ω) = R + jωL + 1/(jωC) + Σ_k R_k/(1 + jωτ_k)                     [SchonleberKlotzIversTiffee2014, (3)–(7)]

    with time constants τ_k fixed, four a decade and one decade beyond both ends of the band, and real R_k of either
    sign, is linear least squares; two time constants a factor 1.8 apart reproduce every relaxation between them to
    10⁻⁷. Weights are 1/σ where the variance is known, else 1/|Z|. The misfit Σ|Z − Ẑ|²·2/σ² is χ² of 2F − rank; of
    variances estimated with d degrees of freedom each term is F(2, 2d), whose sum is taken as the gamma distribution of
    the same mean and variance. Fewer than six degrees of freedom are not judged.

    Raises MisuseError for several channels and for fewer than ten frequencies above zero.
    """
    used = impedance.frequencies > 0
    omega, z = impedance.frequencies[used], impedance.response[used]
    if z.ndim != 1:
        raise MisuseError("an impedance has one input and one output; give one channel", "impedance")
    if len(omega) < LEAST_FREQUENCIES or np.any(z == 0):
        raise MisuseError(
            f"the test takes {LEAST_FREQUENCIES} frequencies above zero or more, none with an impedance of zero",
            "impedance",
        )
    sigma = np.asarray(
        abs(z) if impedance.variance is None else np.sqrt(impedance.variance[used] / 2), dtype=np.float64
    )
    fitted, rank = _fit(omega, z, sigma)
    conjugate, _ = _fit(omega, z.conj(), sigma)
    residual = (z - fitted) / abs(z)
    freedom = 2 * len(omega) - rank
    statistic, p = None, None
    if impedance.variance is not None and freedom > 0:
        statistic = float(np.sum(abs((z - fitted) / sigma) ** 2))
        p = _p_value(statistic, freedom, impedance.variance_degrees_of_freedom)
    return KramersKronig(
        np.asarray(residual, dtype=np.complex128),
        _size(residual),
        _size((z.conj() - conjugate) / abs(z)),
        statistic,
        freedom,
        p,
    )


def _fit(omega: FloatArray, z: ComplexArray, sigma: FloatArray) -> tuple[ComplexArray, int]:
    low, high = 1 / (omega.max() * BEYOND), BEYOND / omega.min()
    count = int(np.ceil(PER_DECADE * np.log10(high / low))) + 1
    most = len(omega) // 2  # so that at least half of what was measured speaks against
    tau = np.geomspace(low, high, min(count, max(most - 3, 1)))
    s = 1j * omega[:, None]
    columns = np.hstack([np.ones_like(s), s, 1 / s, 1 / (1 + s * tau)])
    weighted = np.vstack([columns.real, columns.imag]) / np.tile(sigma, 2)[:, None]
    scale = np.linalg.norm(weighted, axis=0)
    target = np.concatenate([z.real, z.imag]) / np.tile(sigma, 2)
    found, _, rank, _ = np.linalg.lstsq(weighted / scale, target, rcond=1e-12)
    return np.asarray(columns @ (found / scale)), int(rank)


def _size(residual: ComplexArray) -> float:
    return float(np.sqrt(np.mean(abs(residual) ** 2)))


def _p_value(statistic: float, freedom: int, degrees: float | None) -> float | None:
    """Of Σ over freedom/2 terms 2·F(2, 2d), or of χ² when the variances are known exactly."""
    if degrees is None:
        return float(gammaincc(freedom / 2, statistic / 2))
    if degrees < LEAST_DEGREES:
        return None
    mean = freedom * degrees / (degrees - 1)
    variance = freedom / 2 * 4 * degrees**3 / ((degrees - 1) ** 2 * (degrees - 2))
    scale = variance / mean
    return float(gammaincc(mean / scale, statistic / scale))
