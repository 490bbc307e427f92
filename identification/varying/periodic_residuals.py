"""Deviations between the spectrum of a periodic record and that of a model, white with unit variance."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import chdtrc

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.errors import RangeError
from identification.least_squares import LeastSquaresSolution
from identification.outcome import TestResult
from identification.varying.harmonic_blocks import HarmonicBlocks
from identification.varying.harmonic_noise import HarmonicNoise, Whitening, harmonic_noise
from identification.varying.records import SteadyPeriods
from identification.varying.stacks import StackSizes

MOST_ENTRIES = 20_000_000  # complex numbers in the resolvents of all blocks, twice


@dataclass(frozen=True, eq=False)
class PeriodicResiduals:
    """Whitened deviations between the spectrum of the mean period and that of a model [Goos2014, (27)].

        r(θ) = C_e^{−1/2} (Y(θ) − Ȳ),   V_ML = ‖r‖²,   J = ∂r/∂θ

    `periods` were averaged. r (R,) has unit variance for the true θ; J (R, size) has n_x² directions in which nothing
    changes.
    """

    blocks: HarmonicBlocks
    measured: ComplexArray
    noise: HarmonicNoise
    used: BoolArray
    periods: int = 1

    @classmethod
    def of(cls, steady: SteadyPeriods, phi: FloatArray, order: int, zero_frequency: bool = True) -> "PeriodicResiduals":
        """From steady periods along φ (P, k), for models with n_x = `order`.

        Raises RangeError when they need too much memory.
        """
        _require_small(steady, order)
        sizes = StackSizes(order, phi.shape[1], steady.input.shape[1], steady.output.shape[2])
        blocks = HarmonicBlocks(sizes, steady.input, phi, steady.periodicity.scheduling_period)
        spectrum = np.fft.fft(steady.output.mean(axis=0), axis=0)[blocks.lines]
        used = (blocks.lines > 0) | zero_frequency
        return cls(blocks, spectrum, harmonic_noise(steady), used, len(steady.output))

    @cached_property
    def real(self) -> BoolArray:
        """Which of the used lines are those at zero or at the Nyquist frequency."""
        lines = self.blocks.lines[self.used]
        return np.asarray((lines == 0) | (2 * lines == self.blocks.period))

    @cached_property
    def _whitening(self) -> Whitening:
        return Whitening.of(self.noise.covariance[self.blocks.lines[self.used]], self.real)

    @cached_property
    def deviation(self) -> FloatArray:
        """Root of the mean noise variance over the outputs at each line, (F,)."""
        variances = np.einsum("fyy->f", self.noise.covariance[self.blocks.lines].real)
        return np.asarray(np.sqrt(variances / self.measured.shape[1]))

    @property
    def noise_variance(self) -> float:
        """Of one sample of the only output; one where there are several."""
        if self.measured.shape[1] > 1:
            return 1.0
        return float(np.sum(self.noise.covariance.real)) * self.periods / self.blocks.period**2

    def residual(self, theta: FloatArray) -> FloatArray:
        """r (R,)."""
        difference = (self.blocks.output(theta) - self.measured)[self.used]
        return self._whitening(difference[:, :, None])[:, 0]

    def __call__(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """r (R,) and J (R, size)."""
        output, jacobian = self.blocks.output_and_jacobian(theta)
        columns = np.concatenate([(output - self.measured)[:, :, None], jacobian], axis=2)[self.used]
        white = self._whitening(columns)
        return white[:, 0], white[:, 1:]


def _require_small(steady: SteadyPeriods, order: int) -> None:
    period, coupled = steady.periodicity.period, steady.periodicity.scheduling_period
    if period * coupled * order**2 > MOST_ENTRIES:
        raise RangeError(
            f"a scheduling of {coupled} samples in a period of {period} couples too many lines for order {order};"
            " choose a scheduling that repeats itself more often, a shorter period or a lower order",
            "scheduling",
        )


def lack_of_fit(residuals: PeriodicResiduals, solution: LeastSquaresSolution) -> TestResult:
    """χ² test of ‖r‖²; |e_k|² ~ F(2, 2ν) becomes ν ln(1 + |e_k|²/ν), which is χ²(2)/2, and alike at real lines."""
    nu = residuals.noise.degrees_of_freedom
    real = np.repeat(residuals.real, residuals.measured.shape[1])
    power = solution.residual[: len(real)] ** 2
    power[~real] += solution.residual[len(real) :] ** 2
    freedom = np.where(real, nu, 2.0 * nu)
    statistic = float(np.sum(freedom * np.log1p(power / freedom)))
    free = len(solution.residual) - residuals.blocks.sizes.free
    return TestResult("lack of fit", statistic, float(free), float(chdtrc(free, statistic)))
