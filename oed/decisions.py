"""What a decision needs: from stated error rates to a noncentrality, and back."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import chdtri, chndtr, chndtrinc, ndtr, ndtri

from identification.arrays import FloatArray
from identification.errors import RangeError
from oed.hypothesis import Hypothesis

CONVINCED = 2 * np.log(19.0)
RESOLVED = 1e-12


@dataclass(frozen=True)
class ErrorRates:
    """A test with a stated `power` at a stated `level`, of `count` amplitudes; one-sided where the sign is known."""

    power: float
    level: float
    count: int = 1
    one_sided: bool = False

    def __post_init__(self) -> None:
        for name, value in (("power", self.power), ("level", self.level)):
            if not 0 < value < 1:
                raise RangeError(f"the {name} is {value}; it must lie between 0 and 1", name)
        if self.power <= self.level:
            raise RangeError("the power must exceed the level, or no experiment is needed", "power")

    @property
    def noncentrality(self) -> float:
        """The least λ: (z_power + z_1−level)² one-sided, else the λ at which χ²(count, λ) has the power."""
        if self.one_sided:
            return float((ndtri(self.power) - ndtri(self.level)) ** 2)
        return float(chndtrinc(chdtri(self.count, self.level), self.count, 1 - self.power))

    def power_at(self, noncentrality: float) -> float:
        """The power that a noncentrality gives."""
        if self.one_sided:
            return float(ndtr(np.sqrt(noncentrality) + ndtri(self.level)))
        return float(1 - chndtr(chdtri(self.count, self.level), self.count, noncentrality))


def conviction(noncentrality: float) -> float:
    """The probability that the right one of two models of as many parameters gets more than 95 % of the weight.

    The difference of their BIC is normal with mean λ and variance 4 λ; weight ∝ exp(−BIC/2).
    """
    return float(ndtr((noncentrality - CONVINCED) / (2 * np.sqrt(noncentrality)))) if noncentrality > 0 else 0.0


@dataclass(frozen=True, eq=False)
class Demand:
    """A decision that the experiments must allow, with a hypothesis of its own.

    The parameters in `judged` must reach Var ⪯ amplitude²/λ(rates). `kind` and `against` name the effects.
    """

    hypothesis: Hypothesis
    judged: slice
    amplitude: float
    rates: ErrorRates
    kind: str
    against: str | None = None

    @property
    def matrix(self) -> FloatArray:
        """R (k, k): λ/amplitude² on the diagonal of what is judged."""
        result = np.zeros((self.hypothesis.size, self.hypothesis.size))
        places = np.arange(self.hypothesis.size)[self.judged]
        result[places, places] = self.rates.noncentrality / self.amplitude**2
        return result

    def expected(self, information: FloatArray) -> "Decision":
        """What experiments of this information (k, k) about the hypothesis allow: Var = (I_jj − I_jo I_oo⁻¹ I_oj)⁻¹."""
        scale = 1 / np.sqrt(np.maximum(np.diagonal(information), 1e-300))
        correlation = information * np.outer(scale, scale)
        judged = np.zeros(len(information), dtype=np.bool_)
        judged[self.judged] = True
        values, vectors = np.linalg.eigh(correlation[np.ix_(~judged, ~judged)])
        known = values > 1e-13 * values[-1]
        shared = correlation[np.ix_(judged, ~judged)] @ vectors[:, known]
        left = correlation[np.ix_(judged, judged)] - (shared / values[known]) @ shared.T
        least = float(np.linalg.eigvalsh(left / np.outer(scale[judged], scale[judged]))[0])
        if least <= RESOLVED * float(np.max(np.diagonal(information)[judged])):
            return Decision(self, np.inf, 0.0)
        return Decision(self, 1 / least, self.amplitude**2 * least)


@dataclass(frozen=True, eq=False)
class Decision:
    """The expected variance of what is judged (the largest in any direction), and the noncentrality of the test."""

    demand: Demand
    variance: float
    noncentrality: float

    @property
    def power(self) -> float:
        """The expected power of the test."""
        return self.demand.rates.power_at(self.noncentrality)

    @property
    def conviction(self) -> float | None:
        """The probability of a weight above 95 %, of a choice between two effects; None for a detection."""
        return None if self.demand.against is None else conviction(self.noncentrality)

    @property
    def question(self) -> Literal["detection", "discrimination"]:
        """Whether an effect is to be seen, or to be told from another."""
        return "detection" if self.demand.against is None else "discrimination"
