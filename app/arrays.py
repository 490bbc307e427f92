"""Arrays at the border: complex numbers as {"re": […], "im": […]}, and nothing that is not finite."""

from typing import Any

import numpy as np
from pydantic import Field, model_validator

from app.schemas.common import CamelModel, Double
from identification.arrays import ComplexArray, FloatArray

Vector = list[Double]
Matrix = list[list[Double]]


class ComplexVector(CamelModel):
    """Complex numbers by their real and imaginary parts."""

    re: list[Double] = Field(description="real parts")
    im: list[Double] = Field(description="imaginary parts, as many as real parts")

    @model_validator(mode="after")
    def _same_length(self) -> "ComplexVector":
        if len(self.re) != len(self.im):
            raise ValueError(f"re has {len(self.re)} values and im {len(self.im)}; give as many of each")
        return self

    def array(self) -> ComplexArray:
        """The numbers as an array."""
        return np.array(self.re) + 1j * np.array(self.im)

    @classmethod
    def of(cls, values: ComplexArray) -> "ComplexVector":
        """The document of an array (F,)."""
        return cls(re=values.real.tolist(), im=values.imag.tolist())


def finite_or_none(value: float | None) -> float | None:
    """The number, or null where there is none."""
    return None if value is None or not np.isfinite(value) else float(value)


def finite_list_or_none(values: FloatArray) -> Any:
    """The array as nested lists, or null when a part of it is not finite."""
    return values.tolist() if np.isfinite(values).all() else None
