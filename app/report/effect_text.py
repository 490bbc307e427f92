"""Effects in models, in words."""

from app.report.numbers import estimate
from app.schemas.effects import PlacedEffectDocument


def amplitude(effect: PlacedEffectDocument) -> str:
    """The amplitude with its deviation and unit, and the further parameters."""
    deviations = effect.standard_deviations or [[float("nan")] * len(row) for row in effect.coefficients]
    values = [
        estimate(value, deviation)
        for row, own in zip(effect.coefficients, deviations, strict=True)
        for value, deviation in zip(row, own, strict=True)
    ]
    further = [
        f"{one.name} {estimate(one.value, one.standard_deviation or float('nan'))}"
        for one in effect.parameters
        if one.fitted
    ]
    return ", ".join([f"{' | '.join(values)} {effect.unit}", *further])
