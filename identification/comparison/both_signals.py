"""Periodic records whose input does not repeat exactly: noise on it, or a controller that acts on the output."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray
from identification.comparison.adaptation import Adaptation
from identification.comparison.batch import Batch
from identification.comparison.noise import NEIGHBOURS, NoiseOfMean, noise_of_mean, pooled
from identification.comparison.wandering import wandering_noise
from identification.places.place import Flow

NOTICED, LARGEST, FEW = 1e-4, 3.0, 1
SHARES, WORTH = tuple(10.0 ** np.arange(-3, 5.1, 0.5)), 6.0


@dataclass(frozen=True, eq=False)
class BothSignals(Adaptation):
    """Mean spectra U, Y of P periods with errors n_u, n_y on both, of unknown joint covariance.

        Σ_k |Y − G U|²/s → min,   s = Var(Y − G U) = σ_y² + |G|² σ_u² − 2 Re(G* σ_yu),   σ_yu = E n_y n_u*

    [PintelonSchoukens2012, Section 9.11]. s comes from how Y_p − G U_p differ from period to period, pooled over
    lines (`_noise`), with the G of the model, and never from the datum that it weighs. The minimum over the true input
    at every line is Û = U − E(n_u ε*)/s · ε, ε = Y − G U, and with it the gradient of the sum is that of a known input:
    data Û and Y − G(U − Û) are handed on, rebuilt until model and data agree. So is the estimate consistent where u
    depends on past noise of y, for unstable plants as well. ε beyond three deviations is misfit, not noise, and moves
    no input further. Where forces follow from the measured output the line at zero is left out: a plant that does not
    settle makes any error of their mean infinite. `inputs`, `outputs` (M, P, K); `rounding` (M, K): the variance of
    what the converter repeats; `feedback`: a controller acted on the output; `walks`: whose noise wanders.
    """

    inputs: ComplexArray
    outputs: ComplexArray
    rounding: FloatArray
    feedback: bool = False
    walks: tuple[bool, ...] = ()

    def settled(self, batch: Batch, flow: Flow) -> Batch:
        """Input and weights as they follow from the response of the model."""
        response = flow.entry * flow.factor
        errors = self.outputs - response[:, None] * self.inputs
        every = zip(errors, response, self.walks, strict=True)
        found = [_noise(e, g, batch.real, wandering_noise if walks else noise_of_mean) for e, g, walks in every]
        smallest = 1e-26 * np.mean(abs(self.outputs) ** 2, axis=(1, 2)) + float(np.finfo(np.float64).tiny)
        variances = np.maximum(np.stack([one.variance for one in found]), smallest[:, None]) + self.rounding
        variances[np.isinf(batch.variances)] = np.inf
        if batch.measured_law is not None:
            variances[:, 0] = np.inf
        mean_u, mean_y = self.inputs.mean(axis=1), self.outputs.mean(axis=1)
        noise = self._noise_of_input(errors, batch.real)
        left = mean_y - flow.output - response * (mean_u - batch.inputs)
        plausible = LARGEST * np.sqrt(np.where(np.isfinite(variances), variances, 0.0))
        inputs = mean_u - noise * left * np.minimum(1.0, plausible / np.maximum(abs(left), np.finfo(np.float64).tiny))
        length = batch.signals.shape[1] if batch.signals is not None else 1
        return replace(
            batch,
            inputs=inputs,
            outputs=mean_y - response * (mean_u - inputs),
            signals=np.fft.irfft(inputs * length, n=length),
            variances=variances,
            half_width=found[0].half_width,
            freedom=found[0].freedom,
            ends=np.stack([one.ends for one in found]),
        )

    def _noise_of_input(self, errors: ComplexArray, real: BoolArray) -> ComplexArray:
        """E(n_u ε*)/E|ε|² (M, K), the regression of one on the other over the periods of few lines: without bias."""
        u, e = self.inputs - self.inputs.mean(axis=1, keepdims=True), errors - errors.mean(axis=1, keepdims=True)
        common = np.sum(u * e.conj(), axis=1)
        power = np.sum(abs(e) ** 2, axis=1) + float(np.finfo(np.float64).tiny)
        half_width = min(FEW, (int(np.sum(~real)) - 1) // 2)
        pairs = zip(common, power, strict=True)
        return np.stack([_pooled(c, half_width, real) / pooled(p, half_width, real) for c, p in pairs])

    def measured_law(self, batch: Batch) -> ComplexArray | None:
        """The mean output."""
        return np.asarray(self.outputs.mean(axis=1)) if self.feedback else None

    def joined(self, others: "list[BothSignals]") -> "BothSignals":
        """All their records."""
        every = [self, *others]
        return BothSignals(
            np.concatenate([one.inputs for one in every]),
            np.concatenate([one.outputs for one in every]),
            np.concatenate([one.rounding for one in every]),
            any(one.feedback for one in every),
            tuple(walks for one in every for walks in one.walks),
        )


def _noise(
    errors: ComplexArray,
    response: ComplexArray,
    real: BoolArray,
    noise: Callable[[ComplexArray, BoolArray], NoiseOfMean],
) -> NoiseOfMean:
    """Noise of the mean of errors (P, K) whose spectrum may have the shape 1 + ρ |G|² of noise on the input.

        ρ: min 2 (P − 1) Σ_k ln(shape_k · mean over 2w + 1 lines of s_k'/shape_k'),   s the sample variance

    that of lines pooled once the shape is divided out, as a resonance of G is too sharp for a window. ρ = 0, the noise
    of a controlled or of an undisturbed input, unless that lowers it by more than `WORTH`.
    """
    gain = abs(response) ** 2
    spread = np.var(errors, axis=0, ddof=1) + float(np.finfo(np.float64).tiny)
    half_width = min(NEIGHBOURS, (int(np.sum(~real)) - 1) // 2)
    middle = float(np.median(gain))
    if not (middle > 0 and np.all(np.isfinite(gain))):
        return noise(errors, real)
    shapes = [1 + share * gain / middle for share in (0.0, *SHARES)]
    costs = [float(np.sum(np.log(one * pooled(spread / one, half_width, real))[~real])) for one in shapes]
    best = int(np.argmin(costs))
    shape = shapes[best if 2 * (len(errors) - 1) * (costs[0] - costs[best]) > WORTH else 0]
    found = noise(errors / np.sqrt(shape), real)
    return replace(found, variance=shape * found.variance)


def _pooled(values: ComplexArray, half_width: int, real: BoolArray) -> ComplexArray:
    return pooled(values.real, half_width, real) + 1j * pooled(values.imag, half_width, real)


def both_signals(
    u: ComplexArray, y: ComplexArray, excited: BoolArray, rounding: FloatArray, feedback: bool, walks: bool
) -> BothSignals | None:
    """For one record with spectra (P, K), where what differs of its input from period to period matters; else None."""
    ratio = np.where(excited, y.mean(axis=0) / np.where(excited, u.mean(axis=0), 1.0), 0.0)
    by_input = np.sum(abs(ratio * (u - u.mean(axis=0))) ** 2)
    errors = y - ratio * u
    if by_input <= NOTICED * np.sum(abs(errors - errors.mean(axis=0))[:, excited] ** 2):
        return None
    return BothSignals(u[None], y[None], rounding[None], feedback, (walks,))


def excited_in_noise(u: ComplexArray, real: BoolArray) -> BoolArray:
    """Lines (K,) where the mean of P inputs (P, K) stands out of noise that is pooled over lines, not of its own."""
    spread: FloatArray = np.var(u, axis=0, ddof=1) / len(u)
    half_width = min(NEIGHBOURS, (int(np.sum(~real)) - 1) // 2)
    return np.asarray(abs(u.mean(axis=0)) ** 2 > 16 * pooled(spread, half_width, real))
