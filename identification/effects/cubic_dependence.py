"""A coefficient with a cubic part in the scheduling variable that the model has not."""

from dataclasses import dataclass
from typing import ClassVar

from identification.places.dependence import LegendreDependence


@dataclass(frozen=True)
class CubicDependence(LegendreDependence):
    """ζ_i(p) + e P_3(p̃), the Legendre polynomial of degree 3 in p̃ = −1 … 1, i = `coefficient` [Ghosh2018, (2)]."""

    kind: ClassVar[str] = "cubic_dependence"
    title: ClassVar[str] = "cubic dependence of a coefficient on p"
    unit: ClassVar[str] = "unit of the coefficient"
    source: ClassVar[str] = "[Ghosh2018, (2)]"
    degree: ClassVar[int] = 3
