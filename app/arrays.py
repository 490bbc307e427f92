"""Arrays at the border: complex numbers as {"re": […], "im": […]}, and nothing that is not finite."""

from typing import Any

import numpy as np
from pydantic import Field, model_validator

from app.schemas.common import CamelModel, Double
from identification.arrays import ComplexArray, FloatArray

Vector = list[Double]
Matrix = list[list[Double]]
Matrices = list[Matrix]


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


class ComplexMatrices(CamelModel):
    """Complex matrices of one shape, one a frequency with a row for each output and a column for each input."""

    re: Matrices = Field(description="real parts")
    im: Matrices = Field(description="imaginary parts, as many as real parts")

    @model_validator(mode="after")
    def _same_shape(self) -> "ComplexMatrices":
        shapes = matrices_shape(self.re, "re"), matrices_shape(self.im, "im")
        if shapes[0] != shapes[1]:
            raise ValueError(f"re has shape {shapes[0]} and im {shapes[1]}; give as many of each")
        return self

    def array(self) -> ComplexArray:
        """The matrices as an array (F, n_y, n_u)."""
        return np.array(self.re) + 1j * np.array(self.im)

    @classmethod
    def of(cls, values: ComplexArray) -> "ComplexMatrices":
        """The document of an array (F, n_y, n_u)."""
        return cls(re=values.real.tolist(), im=values.imag.tolist())


def matrices_shape(values: Matrices, name: str) -> tuple[int, int, int]:
    """(F, n_y, n_u); raises ValueError when there are none, or when they differ in shape."""
    rows, columns = {len(matrix) for matrix in values}, {len(row) for matrix in values for row in matrix}
    if len(rows) != 1 or len(columns) != 1 or 0 in rows | columns:
        raise ValueError(
            f"{name} holds no matrices, or matrices that differ in shape; give one row an output, one column an input"
        )
    return len(values), rows.pop(), columns.pop()


def finite_or_none(value: float | None) -> float | None:
    """The number, or null where there is none."""
    return None if value is None or not np.isfinite(value) else float(value)


def finite_parts(values: FloatArray) -> Any:
    """The array as nested lists with null for what is not finite, or null when nothing is."""
    known = np.isfinite(values)
    return np.where(known, values, None).tolist() if known.any() else None  # type: ignore[call-overload]


def finite_list_or_none(values: FloatArray) -> Any:
    """The array as nested lists, or null when a part of it is not finite."""
    return values.tolist() if np.isfinite(values).all() else None
