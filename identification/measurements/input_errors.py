"""Errors of the mean input and output behind a measured frequency response."""

from dataclasses import dataclass

import numpy as np

from identification.arrays import BoolArray, ComplexArray, FloatArray, IntArray

NOTICED = 1e-4


@dataclass(frozen=True, eq=False)
class InputErrors:
    """Mean spectra U, Y of a record at F lines with errors on both, of known joint covariance.

        Var(Y − G U) = s = σ_y² + |G|² σ_u² − 2 Re(G* σ_yu),   σ_yu = E n_y n_u*
        Σ_k |Y − G U|²/s → min   ⇔   Û = U − E(n_u ε*)/s · ε,   Ĝ = G + ε/Û with variance s/|Û|²,   ε = Y − G U

    [PintelonSchoukens2012, Section 9.11]. Û is the most likely input where the response is G, so that the gradient of
    Σ |Ĝ − G|² |Û|²/s, data held still, is that of the sum on the left. Y/U with a weight of |U|² has the noise of U in
    both and is biased by σ_u²/|U|². `of_output` is what the rounding of numbers and converters adds to σ_y². Shapes
    (F,).
    """

    input: ComplexArray
    output: ComplexArray
    of_input: FloatArray
    of_output: FloatArray
    common: ComplexArray
    least: FloatArray

    def variance(self, response: ComplexArray) -> FloatArray:
        """s (F,) where the response is G (F,)."""
        s = self.of_output + abs(response) ** 2 * self.of_input - 2 * np.real(response.conj() * self.common)
        return np.asarray(np.maximum(s, self.least))

    def under(self, response: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        """Ĝ (F,) and its variance (F,) where the response of the model is G (F,)."""
        s = self.variance(response)
        left = self.output - response * self.input
        together = self.common.conj() - response.conj() * self.of_input
        input = self.input - together / s * left
        return np.asarray(response + left / input), np.asarray(s / abs(input) ** 2)

    def lines(self, kept: slice | IntArray) -> "InputErrors":
        """The same at some of the lines."""
        return InputErrors(
            self.input[kept],
            self.output[kept],
            self.of_input[kept],
            self.of_output[kept],
            self.common[kept],
            self.least[kept],
        )

    @classmethod
    def of_mean(cls, u: ComplexArray, y: ComplexArray, added: FloatArray, real: BoolArray) -> "InputErrors | None":
        """From the spectra (P, F) of P periods; None where the input repeats, or nearly.

        The sample covariances over the periods, divided by P; twice those at `real` lines, as everywhere of real
        numbers; `added` (F,) to the variance of the output of a period.
        """
        count = len(u)
        away_u, away_y = u - u.mean(axis=0), y - y.mean(axis=0)
        share = np.where(real, 2.0, 1.0) / (count * (count - 1))
        of_input = share * np.sum(abs(away_u) ** 2, axis=0)
        of_output = share * np.sum(abs(away_y) ** 2, axis=0) + added / count
        common = share * np.sum(away_y * away_u.conj(), axis=0)
        mean_u, mean_y = u.mean(axis=0), y.mean(axis=0)
        found = cls(mean_u, mean_y, of_input, of_output, common, added / count)
        by_input = float(np.sum(abs(mean_y / mean_u) ** 2 * of_input))
        return found if by_input > NOTICED * float(np.sum(found.variance(mean_y / mean_u))) else None
