"""What measurements say about a plant: data in, models with covariance out. No HTTP, no files, no clock.

The names below are loaded when they are first asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from identification.bases.b_spline import BSpline
    from identification.bases.chebyshev import Chebyshev
    from identification.bases.polynomial import Polynomial
    from identification.errors import MisuseError
    from identification.estimates import Estimate
    from identification.methods.identify import identify
    from identification.methods.two_step import TwoStep
    from identification.models.model import Model
    from identification.models.physical import Coefficient, PhysicalForm
    from identification.models.rational import RationalStructure
    from identification.models.state_space import StateSpaceStructure
    from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
    from identification.signals import FrequencyResponse, TimeRecord
    from identification.varying.records import VaryingRecord

_MODULES = {
    "BSpline": "bases.b_spline",
    "Chebyshev": "bases.chebyshev",
    "Coefficient": "models.physical",
    "Estimate": "estimates",
    "FrequencyResponse": "signals",
    "MisuseError": "errors",
    "Model": "models.model",
    "ParameterDependence": "scheduling",
    "PhysicalForm": "models.physical",
    "Polynomial": "bases.polynomial",
    "ProductBasis": "scheduling",
    "RationalStructure": "models.rational",
    "SchedulingVariable": "scheduling",
    "StateSpaceStructure": "models.state_space",
    "TimeRecord": "signals",
    "TwoStep": "methods.two_step",
    "VaryingRecord": "varying.records",
    "identify": "methods.identify",
}

__all__ = [
    "BSpline",
    "Chebyshev",
    "Coefficient",
    "Estimate",
    "FrequencyResponse",
    "MisuseError",
    "Model",
    "ParameterDependence",
    "PhysicalForm",
    "Polynomial",
    "ProductBasis",
    "RationalStructure",
    "SchedulingVariable",
    "StateSpaceStructure",
    "TimeRecord",
    "TwoStep",
    "VaryingRecord",
    "identify",
]


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'identification' has no attribute {name!r}")
    return getattr(import_module(f"identification.{_MODULES[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
