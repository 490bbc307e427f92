"""How well a model reproduces a record along varying scheduling."""

from dataclasses import dataclass
from typing import cast

import numpy as np

from identification.arrays import FloatArray
from identification.errors import RangeError, ShapeError
from identification.models.model import Model
from identification.models.recursion import propagate
from identification.models.state_space import StateSpaceStructure
from identification.varying.rates import best_fit_rate, variance_accounted_for
from identification.varying.records import VaryingRecord

RANK = 1e-10


@dataclass(frozen=True, eq=False)
class Reproduction:
    """ŷ (N, n_y) along a record from the initial state x̂(0) (n_x,) that fits best; BFR and VAF in %."""

    output: FloatArray
    initial_state: FloatArray
    best_fit_rate: float
    variance_accounted_for: float


def reproduced(model: Model, record: VaryingRecord) -> Reproduction:
    """The simulation along a record; a few samples at its beginning tell the state that it starts from.

        x̂(0) = arg min Σ_t ‖y(t) − ŷ(t) − C(t) Φ(t) x(0)‖²,   Φ(t) = A(t−1) ⋯ A(0)

    Raises ShapeError for other channels than the model's, RangeError for a model that is unstable along this p(t) or
    an output that does not vary.
    """
    require_same_channels(model, record)
    zeta, structure = model.coefficients(record.scheduling), cast(StateSpaceStructure, model.structure)
    forced = structure.along(zeta, record.input).output
    (a, _, c, _), n = structure.matrices(zeta), structure.order
    with np.errstate(over="ignore", invalid="ignore"):
        states = propagate(a, np.zeros((n, len(record), n)), np.eye(n))[:, :-1]
        free = (c @ states[..., None])[..., 0]
    if not (np.all(np.isfinite(free)) and np.all(np.isfinite(forced))):
        raise RangeError("the model is unstable along this scheduling", "model")
    columns = free.reshape(n, -1).T
    start: FloatArray = np.asarray(np.linalg.lstsq(columns, (record.output - forced).ravel(), rcond=RANK)[0])
    output = forced + (columns @ start).reshape(forced.shape)
    return Reproduction(
        output, start, best_fit_rate(record.output, output), variance_accounted_for(record.output, output)
    )


def require_same_channels(model: Model, record: VaryingRecord) -> None:
    """Raises ShapeError unless a record has the channels of a model, and its sample time."""
    own = (model.structure.inputs, model.structure.outputs, len(model.variables))
    given = tuple(signal.shape[1] for signal in (record.input, record.output, record.scheduling))
    if own != given:
        raise ShapeError(f"the model has {own} inputs, outputs and scheduling signals, the record {given}", "record")
    step = model.structure.sample_time
    if step is None or abs(record.sample_time / step - 1) > 1e-6:
        raise RangeError(
            f"the record is sampled every {record.sample_time:g} s, the model every {step} s",
            "sample_time",
        )
