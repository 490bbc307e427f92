"""Confidence bands of gain and phase from the covariance of a complex frequency response; roots of covariances."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import ComplexArray, FloatArray

QUANTILE_95 = 1.959963984540054


@dataclass(frozen=True, eq=False)
class GainAndPhase:
    """|G| and arg G (rad) with their standard deviations, all (F,)."""

    gain: FloatArray
    phase: FloatArray
    gain_deviation: FloatArray
    phase_deviation: FloatArray

    def gain_band(self) -> tuple[FloatArray, FloatArray]:
        """The 95 % band of the gain, not below zero."""
        half = QUANTILE_95 * self.gain_deviation
        return np.maximum(self.gain - half, 0.0), self.gain + half

    def phase_band(self) -> tuple[FloatArray, FloatArray]:
        """The 95 % band of the phase in rad, at most π to each side, where nothing is known any more."""
        half = np.minimum(QUANTILE_95 * self.phase_deviation, np.pi)
        return self.phase - half, self.phase + half


def gain_and_phase(response: ComplexArray, covariance: FloatArray, phase: FloatArray | None = None) -> GainAndPhase:
    """Gain and phase of G (F,) whose (Re, Im) have the covariance C (F, 2, 2), to first order in C.

        var|G| = rᵀ C r,   var(arg G) = tᵀ C t / |G|²,   r = (Re G, Im G)/|G|,   t = (−Im G, Re G)/|G|

    `phase` (F,) is arg G as it runs between these frequencies; without it what is nearest from one to the next, which
    is wrong where the phase turns by more than π between them. Where G is zero its phase is not known at all (infinite
    deviation), and r is any direction.
    """
    gain = np.abs(response)
    unit = np.where(gain > 0, response / np.where(gain > 0, gain, 1.0), 1.0)
    along = np.stack([unit.real, unit.imag], axis=-1)
    across = np.stack([-unit.imag, unit.real], axis=-1)
    gain_variance = np.einsum("fi,fij,fj->f", along, covariance, along)
    across_variance = np.einsum("fi,fij,fj->f", across, covariance, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        phase_deviation = np.where(gain > 0, np.sqrt(np.maximum(across_variance, 0.0)) / gain, np.inf)
    angle = np.unwrap(np.angle(response)) if phase is None else phase
    return GainAndPhase(gain, angle, np.sqrt(np.maximum(gain_variance, 0.0)), phase_deviation)


def covariance_root(covariance: FloatArray) -> FloatArray:
    """R (k, r) with R Rᵀ = P (k, k), one column a direction that is not known exactly."""
    scale = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    size = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(size, size))
    kept = values > 1e-14 * max(float(values[-1]), 0.0)
    return np.asarray(size[:, None] * vectors[:, kept] * np.sqrt(values[kept]))
