"""An effect that must not be missed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.comparison.batch import Batch
from identification.errors import RangeError
from identification.models.model import Model
from identification.places.place import Effect
from identification.places.placed import placed
from oed.decisions import Demand, ErrorRates
from oed.hypothesis import Hypothesis
from oed.suspects import named


@dataclass(frozen=True)
class EffectDetection:
    """See an effect of the library of a given size with given power, in a test at a given level: Var(e) ≤ δ²/λ.

    λ is the noncentrality that the score test of e = 0 needs, one-sided where the sign of the effect is physical; θ and
    all effects in the model stay free. An effect that the model carries is judged at the amplitude that it has.
    """

    kind: ClassVar[str] = "effect_detection"

    effect: Annotated[str, "kind of the effect, as in the catalogue"]
    amplitude: Annotated[float, "δ, the amplitude that must be seen, in the unit of the effect"]
    parameters: Annotated[
        tuple[float, ...], "its further parameters, in the order in which a diagnosis lists them"
    ] = ()
    power: Annotated[float, "probability that an effect of this size is seen"] = 0.9
    level: Annotated[float, "probability that the test sees an effect that is not there"] = 0.05

    def __post_init__(self) -> None:
        if not (np.isfinite(self.amplitude) and self.amplitude != 0):
            raise RangeError("the amplitude must be finite and not zero", "amplitude")
        ErrorRates(self.power, self.level)
        effect = named(self.effect, self.parameters)
        if effect.sign * self.amplitude < 0:
            raise RangeError(f"the amplitude of {effect.title} cannot have this sign", "amplitude")

    def demands(self, model: Model, reference: Sequence[Batch], measured: bool) -> tuple[Demand, ...]:
        """One hypothesis: the model with this effect at amplitude zero, or the model itself when it carries it."""
        effect = named(self.effect, self.parameters)
        rates = ErrorRates(self.power, self.level, effect.shapes, effect.shapes == 1 and effect.sign != 0)
        there = _place_in(model, effect)
        if there is not None:
            return (Demand(Hypothesis(model), there, self.amplitude, rates, self.effect),)
        one = placed(effect, 0, 1)
        start = len(model.parameters)
        judged = slice(start, start + one.size)
        return (Demand(Hypothesis(model, suspected=one), judged, self.amplitude, rates, self.effect),)

    @classmethod
    def example(cls, model: Model) -> "EffectDetection":
        """A delay of a tenth of a second, for the conformance tests."""
        return cls("delay", 0.1)


def _place_in(model: Model, effect: Effect) -> slice | None:
    """Where the first amplitude coefficients of an effect of this kind stand among the parameters of the model."""
    start = model.plant_size
    for one in model.effects:
        if one.effect.kind == effect.kind:
            return slice(start, start + one.size)
        start += len(one.parameters())
    return None
