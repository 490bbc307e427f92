"""Simulations: models of all kinds along p(t), and outputs as documents."""

from collections.abc import Mapping, Sequence

import numpy as np

from app.arrays import finite_or_none
from app.conversion.models import kept_model
from app.conversion.plants import is_state_space, scheduling_variables
from app.conversion.state_space import kept_state_space
from app.conversion.varying_models import kept_varying
from app.schemas.experiments import SchedulingRange
from app.schemas.models import Model
from app.schemas.plants import ContinuousTimeStructure, Plant
from app.schemas.simulations import LeftOutEffect, SimulatedOutput
from identification.along import Simulation, simulate_along
from identification.arrays import FloatArray
from identification.errors import MisuseError
from identification.extension.steady_period import LeftOut

FROZEN = (
    "The model was identified at operating points that were held still; its coefficients follow p(t) at once, and what"
    " fast changes of p do beyond that is not in it."
)
NO_BAND = "The model has no covariance, so there is no band."
NO_BAND_NEAR = "Parameters that are nearly as likely have no steady state, so there is no band."
BAND_LIMITED = (
    "Between its samples the input is the sum of its sine waves below the Nyquist frequency, not held constant."
)
NO_BAND_ALONG = "The band of this kind of model is known at operating points only, not along p(t)."


def simulated(model: Model, plant: Plant, u: FloatArray, p: FloatArray) -> tuple[Simulation, list[str]]:
    """The simulation, and what it leaves out; raises MisuseError."""
    unknown = [] if model.covariance is not None else [NO_BAND]
    if model.varying is not None:
        return simulate_along(kept_varying(model, plant), u, p, model.covariance is not None), unknown
    if is_state_space(model.structure):
        frozen = kept_state_space(model, plant)
        if frozen is None:
            raise MisuseError("this model is one of single operating points only; it cannot follow p(t)", "model")
        return simulate_along(frozen, u, p, covariance_known=False), [FROZEN, *(unknown or [NO_BAND_ALONG])]
    found = simulate_along(kept_model(model, plant), u, p, model.covariance is not None)
    return found, [FROZEN, *unknown]


def steady_notes(model: Model, logged: Mapping[str, float], known: bool, banded: bool) -> list[str]:
    """What is to be known of a steady state; `known` whether the model has a covariance, `banded` whether it served."""
    quantities = sorted({one.quantity for one in model.effects if one.quantity is not None})
    notes = [f"{name} is taken as {logged[name]:g}." for name in quantities]
    if isinstance(model.structure, ContinuousTimeStructure):
        notes.append(BAND_LIMITED)
    return notes if banded else [*notes, NO_BAND_NEAR if known else NO_BAND]


def left_out_documents(left_out: Sequence[LeftOut]) -> list[LeftOutEffect]:
    """The effects that a simulation does not hold."""
    return [LeftOutEffect(kind=one.effect.kind, title=one.effect.title, reason=one.reason) for one in left_out]


def output_documents(found: Simulation, points: FloatArray | None = None) -> list[SimulatedOutput]:
    """Each output (N,) in short; those of a steady state belong to operating points (M, s)."""
    where = [None] * found.output.shape[1] if points is None else points.tolist()
    deviations = [None] * found.output.shape[1] if found.deviation is None else list(found.deviation.T)
    return [
        SimulatedOutput(
            operating_point=point,
            minimum=float(y.min()),
            maximum=float(y.max()),
            root_mean_square=float(np.sqrt(np.mean(y**2))),
            deviation=None if deviation is None else finite_or_none(float(np.sqrt(np.mean(deviation**2)))),
        )
        for y, deviation, point in zip(found.output.T, deviations, where, strict=True)
    ]


def range_documents(plant: Plant, scheduling: FloatArray) -> list[SchedulingRange]:
    """Where each scheduling signal (N, s) ran."""
    return [
        SchedulingRange(name=one.name, unit=one.unit, minimum=float(p.min()), maximum=float(p.max()))
        for one, p in zip(scheduling_variables(plant), scheduling.T, strict=True)
    ]
