"""One effect told from another that looks much the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.comparison.batch import Batch
from identification.errors import RangeError
from identification.models.model import Model
from identification.places.place import Effect
from oed.decisions import Demand, ErrorRates
from oed.hypothesis import Hypothesis
from oed.suspects import acts, imitation, known, named, with_effect


@dataclass(frozen=True)
class EffectDiscrimination:
    """Tell one effect from another with stated error rates: when the first is there, the second must be rejected.

        λ = min over θ, e_Y of ‖(Ŷ_X(δ) − Ŷ_Y(θ, e_Y))/σ‖² ≥ (z_power + z_1−level)²             [AtkinsonFedorov1975]

    The second effect may imitate the first as well as it can, with all parameters of the model free: a T-optimal
    experiment for the two. `both_ways` asks the same with the two effects exchanged, where the second can imitate the
    first at all.
    """

    kind: ClassVar[str] = "effect_discrimination"

    effect: Annotated[str, "kind of the effect that is there, as in the catalogue"]
    against: Annotated[str, "kind of the effect that is to be rejected then"]
    amplitude: Annotated[
        float | None, "δ of the effect that is there, in its unit; null: as fitted to the earlier experiments"
    ] = None
    parameters: Annotated[
        tuple[float, ...], "its further parameters, in the order in which a diagnosis lists them; needed with amplitude"
    ] = ()
    power: Annotated[float, "probability that the wrong effect is rejected"] = 0.9
    level: Annotated[float, "probability that the right one would be"] = 0.05
    both_ways: Annotated[bool, "also with the two effects exchanged"] = True

    def __post_init__(self) -> None:
        if self.amplitude is not None and not (np.isfinite(self.amplitude) and self.amplitude != 0):
            raise RangeError("the amplitude must be finite and not zero", "amplitude")
        ErrorRates(self.power, self.level)
        effect = self._first()
        if effect.sign * (self.amplitude or 0.0) < 0:
            raise RangeError(f"the amplitude of {effect.title} cannot have this sign", "amplitude")
        if self.against == self.effect:
            raise RangeError("an effect cannot be told from itself", "against")
        known(self.against, "against")

    def demands(self, model: Model, reference: Sequence[Batch], measured: bool) -> tuple[Demand, ...]:
        """One hypothesis a way: the model with the wrong effect, and the right one as its rival.

        `reference`: experiments in which the two effects are made alike; `measured` says that these were done.
        """
        if self.amplitude is None and not measured:
            raise RangeError("state the amplitude, or name the experiments that showed it", "amplitude")
        rates = ErrorRates(self.power, self.level, one_sided=True)
        first = with_effect(model, self._first(), self.amplitude, reference)
        second = imitation(model, self.against, first, reference)
        demands = [_rejected(second, first, rates, self.effect, self.against)]
        if self.both_ways and acts(second, reference):
            imitated = imitation(model, self.effect, second, reference)
            demands.append(_rejected(imitated, second, rates, self.against, self.effect))
        return tuple(demands)

    def _first(self) -> Effect:
        return known(self.effect, "effect") if self.amplitude is None else named(self.effect, self.parameters)

    @classmethod
    def example(cls, model: Model) -> "EffectDiscrimination":
        """A delay of half a second and a lag, for the conformance tests."""
        return cls("delay", "lag", 0.5)


def _rejected(wrong: Model, right: Model, rates: ErrorRates, kind: str, against: str) -> Demand:
    place = len(wrong.parameters)
    return Demand(Hypothesis(wrong, rival=right), slice(place, place + 1), 1.0, rates, kind, against)
