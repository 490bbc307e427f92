"""Batches whose weights follow from the model, settled together with it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from identification.comparison.batch import Batch
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.models.model import Model
from identification.places.core import core_response
from identification.places.place import Setting

ROUNDS, SETTLED = 8, 1e-3
SETTLING = 0.05
BESIDE = 1e-6


def settled(model: Model, batches: Sequence[Batch], refit: bool = True) -> tuple[Batch, ...]:
    """The batches with weights, transients and inputs as the model has them; others are handed back as they are.

    Fit and weights alternate until no variance changes by more than 10⁻³, the fixed point of the likelihood of both;
    without `refit` the model stays what it is and only the weights are found. Under feedback a plant that does not
    settle by itself is not simulated: forces that effects feed back follow from the measured output.
    """
    found = tuple(batches)
    if not any(batch.adaptation for batch in found):
        return found
    for _ in range(ROUNDS):
        rounds = tuple(_under(model, batch) for batch in found)
        changed = max(_change(old, new) for old, new in zip(found, rounds, strict=True))
        found = rounds
        if changed < SETTLED:
            break
        if refit:
            model = fit(model, Rows(found)).model
    return found


def off_poles(model: Model, batches: Sequence[Batch]) -> Model:
    """The model, or one beside it where a pole lies on a line of the batches, at which G has no value.

    An axis that integrates is stated with a_n = 0, and its G(0) is infinite: of θ, what is zero becomes 10⁻⁶ of the
    largest entry, from which a fit begins as well.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        finite = all(np.isfinite(core_response(model.setting(b.points, b.ports), (), b.omega)).all() for b in batches)
    if finite:
        return model
    return replace(model, theta=np.where(model.theta == 0, BESIDE * np.max(abs(model.theta)), model.theta))


def _under(model: Model, batch: Batch) -> Batch:
    if batch.adaptation is None:
        return batch
    law = None if forgets(model.setting(batch.points), batch) else batch.adaptation.measured_law(batch)
    begun = replace(batch, measured_law=law)
    found: Batch = batch.adaptation.settled(begun, model.respond(begun))
    return found


def _change(old: Batch, new: Batch) -> float:
    used = np.isfinite(old.variances) & np.isfinite(new.variances)
    return float(np.max(abs(np.log(new.variances[used] / old.variances[used])), initial=0.0))


def forgets(setting: Setting, batch: Batch) -> bool:
    """Whether every plant of a batch forgets its state within a twentieth of the signals: then it can be simulated."""
    poles = setting.structure.poles(setting.zeta)
    assert batch.signals is not None
    length = SETTLING * batch.signals.shape[1]
    if setting.structure.is_discrete:
        return bool(np.all(abs(poles) ** length < np.exp(-1)))
    return bool(np.all(poles.real * length * (batch.sample_time or 1.0) < -1))
