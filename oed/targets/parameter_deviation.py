"""Standard deviations of the parameters θ."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError
from identification.models.model import Model


@dataclass(frozen=True)
class ParameterDeviation:
    """Standard deviations σ_i of the entries of θ: √[P_θ]_ii ≤ σ_i [Ghosh2018, Section 3.1].

    Jointly, P_θ⁻¹ ⪰ R = diag(1/σ_1², …, 1/σ_k²): the ellipsoid of P_θ lies inside the one with these half axes, as in
    the paper. Otherwise R_i = e_i e_iᵀ/σ_i² for each i alone, which takes less energy and says nothing about
    combinations of parameters. An entry None sets no target for that parameter.
    """

    kind: ClassVar[str] = "parameter_deviation"

    standard_deviations: Annotated[tuple[float | None, ...], "σ_i of each parameter, in its unit; null for none"]
    jointly: Annotated[bool, "all parameters at once, as an ellipsoid"] = True

    def matrices(self, model: Model) -> FloatArray:
        """R (1, k, k) or one per parameter (J, k, k); raises ShapeError and RangeError."""
        k = model.plant_size + model.noise_size
        if len(self.standard_deviations) != k:
            raise ShapeError(
                f"{len(self.standard_deviations)} standard deviations were given for {k} parameters"
                f" ({', '.join(model.parameter_names)})",
                "standard_deviations",
            )
        wanted = [(i, sigma) for i, sigma in enumerate(self.standard_deviations) if sigma is not None]
        if not wanted or any(not (np.isfinite(sigma) and sigma > 0) for _, sigma in wanted):
            raise RangeError(
                "standard deviations must be positive, and at least one must be given", "standard_deviations"
            )
        single = np.zeros((len(wanted), k, k))
        for j, (i, sigma) in enumerate(wanted):
            single[j, i, i] = sigma**-2
        return single.sum(axis=0, keepdims=True) if self.jointly else single

    @classmethod
    def example(cls, model: Model) -> "ParameterDeviation":
        """One per cent of each parameter, for the conformance tests."""
        return cls(tuple(0.01 * max(abs(value), 1.0) for value in model.theta))
