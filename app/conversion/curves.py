"""Curves without a name, drawn where the data are."""

import numpy as np

from app.arrays import finite_list_or_none
from app.schemas.effects import CurveDocument
from identification.arrays import FloatArray
from identification.effects.law import Law
from identification.models.model import Model
from identification.places.placed import PlacedEffect

COUNT = 81


def curve_document(model: Model, one: PlacedEffect, covariance: FloatArray | None) -> CurveDocument | None:
    """The curve of an effect, None where it is none; `covariance` of its amplitude coefficients."""
    law = one.effect
    if not isinstance(law, Law):
        return None
    x = np.linspace(law.knots[int(law.on_signals)], law.knots[-1 - int(law.on_signals)], COUNT)
    inner, shapes = one.coefficients[:, 0], law.curve(one.coefficients[:, 0])
    values = shapes.each(x)
    width = one.coefficients.shape[1]
    known = None if covariance is None else covariance[::width, ::width]
    band = None if known is None else np.sqrt(np.maximum(np.einsum("ix,ij,jx->x", values, known, values), 0.0))
    label, unit, value_unit = _words(model, law)
    return CurveDocument(
        over=law.over,
        knots=list(law.knots),
        argument_label=label,
        argument_unit=unit,
        value_unit=value_unit,
        argument=_shown(model, law, x).tolist(),
        value=(inner @ values).tolist(),
        standard_deviation=None if band is None else finite_list_or_none(band),
    )


def _shown(model: Model, law: Law, x: FloatArray) -> FloatArray:
    """x in the unit that it is drawn in."""
    if law.on_signals:
        return x
    variable = model.dependence.variables[law.variable]
    return np.asarray(variable.minimum + (x + 1) / 2 * (variable.maximum - variable.minimum))


def _words(model: Model, law: Law) -> tuple[str, str, str]:
    """Label and unit of x, unit of the curve."""
    if law.over == "scheduling":
        variable = model.dependence.variables[law.variable]
        name = model.structure.coefficient_names[law.coefficient]
        return variable.name, variable.unit, f"unit of {name}"
    if law.over in ("input", "output"):
        return law.over, f"{law.over} unit", f"{law.over} unit"
    carrier = "input" if law.driven else "output"
    power = law.order - int(law.over == "flow")
    unit = f"{carrier} unit" + {0: "", 1: " · s", -1: "/s"}.get(power, f" · s^{power}")
    return law.over, unit, "output unit" if law.driven else "input unit"
