"""θ and the effects of a model estimated together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import FloatArray
from identification.extension.rows import Rows, effect_tangents, plant_tangents
from identification.models.model import Model
from identification.outcome import Outcome
from identification.places.place import Flow
from identification.places.steady import NoSteadyStateError

HALVINGS = 6
POLISHING, POLISHED = 4, 1e-3
RELATIVE = {True: 1e-4, False: 1e-3}


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model with its whitened residual (R,), tangents (parameters, R) and the signals of each batch."""

    model: Model
    residual: FloatArray
    tangents: FloatArray
    flows: tuple[Flow, ...]
    rows: Rows
    outcome: Outcome

    @property
    def cost(self) -> float:
        """‖r‖², or n ln(‖r‖²/n) for batches whose noise has no known size: minus twice the log-likelihood."""
        parts = zip(self.rows.batches, self.rows.parts(self.residual), strict=True)
        return sum(_cost(batch.row_count, batch.scaled, part) for batch, part in parts)


def _cost(count: int, scaled: bool, residual: FloatArray) -> float:
    energy = float(residual @ residual)
    return energy if scaled else count * float(np.log(max(energy, np.finfo(float).tiny) / count))


def fit(
    model: Model,
    rows: Rows,
    iterations: int = 20,
    tolerance: float = 1e-3,
    exact: bool = False,
    hopeless: float = np.inf,
    start: Sequence[Flow] | None = None,
) -> Fit:
    """Minimise ‖(Y − Ŷ(θ_G, e, η))/σ‖², and penalties of effects, by Gauss–Newton steps halved until they lead down.

    Tangents are exact for effects that act linearly; for effects on signals they leave out terms of the order of the
    effect itself, so that the minimum is reached in a few steps more. With `exact` the last steps are taken
    with derivatives by differences of the simulation, which also give the covariance. Stops when a step promises less
    than `tolerance` of ‖r‖², or after two steps when twice what it promises still leaves ‖r‖² above `hopeless`.
    `start`: the signals to begin with, where they are known. Outcome "not_converged" after
    `iterations`, unless the last step promised less than a ten-thousandth of a ‖r‖² that a misfit
    makes large (a thousandth where the size of the noise is not known).
    """
    current, promised = _at(model, rows, start), np.inf
    outcome = Outcome("not_converged", "the fit stopped before its minimum; start nearer or fit fewer effects", 0)
    for i in range(iterations):
        step, promised = gauss_newton_step(*penalised(current))
        if promised < tolerance:
            outcome = Outcome("converged", "", i)
            break
        if i >= 2 and _energy(current) - 2 * promised > hopeless:
            break
        better = _descend(current, step)
        if better is None:
            outcome = Outcome("converged", "", i)
            break
        current = better
    if outcome.status == "not_converged" and promised < RELATIVE[rows.scaled] * _energy(current):
        outcome = Outcome("converged", "", iterations)
    if exact and current.model.effects:
        current = _polished(current)
    return replace(current, model=_with_covariance(current), outcome=outcome)


def _energy(found: Fit) -> float:
    """‖r‖² with the penalties."""
    return float(found.residual @ found.residual) + penalty(found.model)


def precisions(model: Model) -> FloatArray:
    """1/variance of each of `model.parameters` before anything is measured, nought unless it is penalised."""
    parts = [np.zeros(model.plant_size)]
    for one in model.effects:
        own = np.repeat(one.effect.precision(), one.coefficients.shape[1])
        parts.append(np.pad(own, (0, len(one.parameters()) - one.size)))
    return np.concatenate(parts)


def penalty(model: Model) -> float:
    """Σ c²/variance over the penalised amplitudes."""
    return float(precisions(model) @ model.parameters**2)


def penalised(found: Fit) -> tuple[FloatArray, FloatArray]:
    """Tangents (k, R + n) and residual (R + n,) with a row −c/σ_c more for each of the n penalised amplitudes."""
    root = np.sqrt(precisions(found.model))
    chosen = np.flatnonzero(root)
    if not len(chosen):
        return found.tangents, found.residual
    more = np.diag(root)[:, chosen]
    values = -root[chosen] * found.model.parameters[chosen]
    return np.hstack([found.tangents, more]), np.concatenate([found.residual, values])


def _at(model: Model, rows: Rows, before: Sequence[Flow] | None) -> Fit:
    starts = [None] * len(rows.batches) if before is None else before
    flows = tuple(model.respond(batch, start) for batch, start in zip(rows.batches, starts, strict=True))
    tangents = [plant_tangents(model, rows, flows), *(effect_tangents(one, rows, flows) for one in model.effects)]
    return Fit(model, rows.residual(flows), np.concatenate(tangents), flows, rows, Outcome("converged"))


def gauss_newton_step(tangents: FloatArray, residual: FloatArray) -> tuple[FloatArray, float]:
    """The Gauss–Newton step and the decrease of ‖r‖² that it promises."""
    size = np.linalg.norm(tangents, axis=1)
    size = np.where(size > 0, size, 1.0)
    gram = (tangents @ tangents.T) / np.outer(size, size)
    gradient = (tangents @ residual) / size
    values, vectors = np.linalg.eigh(gram)
    kept = values > 1e-11 * values[-1]
    projected = vectors[:, kept].T @ gradient
    return vectors[:, kept] @ (projected / values[kept]) / size, float(np.sum(projected**2 / values[kept]))


def _descend(current: Fit, step: FloatArray) -> Fit | None:
    before = _energy(current)
    scaled = 1.0
    for _ in range(HALVINGS):
        trial = moved(current, scaled * step)
        try:
            found = _at(trial, current.rows, current.flows)
        except NoSteadyStateError:
            scaled /= 4
            continue
        if _energy(found) < before:
            return found
        scaled /= 3
    return None


def moved(current: Fit, step: FloatArray) -> Model:
    """The model after a step; further parameters are multiplied, all keep to their physical range."""
    model = current.model
    plant = model.plant_size
    values = model.parameters + step
    start = plant
    old = model.parameters
    for one in model.effects:
        end = start + one.size
        further = slice(end, start + len(one.parameters()))
        grown = old[further] * np.exp(np.clip(step[further], -0.7, 0.7))
        values[further] = np.clip(grown, *one.effect.limits(current.flows[0]))
        if one.degree == 0 and one.effect.sign:
            values[start:end] = np.maximum(one.effect.sign * values[start:end], 0.0) * one.effect.sign
        start = further.stop
    return model.with_parameters(values)


def _polished(current: Fit) -> Fit:
    for _ in range(POLISHING):
        current = replace(current, tangents=differences(current))
        step, promised = gauss_newton_step(*penalised(current))
        better = _descend(current, step) if promised > POLISHED else None
        if better is None:
            return current
        current = better
    return replace(current, tangents=differences(current))


def differences(current: Fit) -> FloatArray:
    """∂Ŷ by all parameters (further parameters by their logarithm) from differences of the simulation, whitened."""
    return np.stack([_difference(current, i, tangent) for i, tangent in enumerate(current.tangents)])


def _difference(current: Fit, i: int, tangent: FloatArray) -> FloatArray:
    """By one parameter: to its other side where this one has no steady state; the tangent itself where neither has."""
    length = float(np.linalg.norm(tangent))
    for size in (0.1 / length, -0.1 / length) if length > 0 else ():
        step = np.zeros(len(current.tangents))
        step[i] = size
        changed = _free_move(current.model, step)
        try:
            change = [changed.respond(flow.batch, flow).output - flow.output for flow in current.flows]
        except NoSteadyStateError:
            continue
        return current.rows.whiten(change) / size
    return tangent


def _free_move(model: Model, step: FloatArray) -> Model:
    values = model.parameters
    start = model.plant_size
    values[:start] += step[:start]
    for one in model.effects:
        end, stop = start + one.size, start + len(one.parameters())
        values[start:end] += step[start:end]
        values[end:stop] *= np.exp(step[end:stop])
        start = stop
    return model.with_parameters(values)


def _with_covariance(found: Fit) -> Model:
    """(JᵀJ)⁻¹, further parameters by their own value; times ‖r‖²/(R − k) where the size of the noise is not known."""
    scale = np.ones(len(found.tangents))
    start = found.model.plant_size
    for one in found.model.effects:
        stop = start + len(one.parameters())
        scale[start + one.size : stop] = one.effect.values()
        start = stop
    tangents = penalised(found)[0] / scale[:, None]
    size = np.linalg.norm(tangents, axis=1)
    if np.any(size == 0):
        return replace(found.model, joint_covariance=None)
    gram = (tangents @ tangents.T) / np.outer(size, size)
    values, vectors = np.linalg.eigh(gram)
    if values[0] <= 1e-11 * values[-1]:
        return replace(found.model, joint_covariance=None)
    inverse = (vectors / values) @ vectors.T / np.outer(size, size)
    if not found.rows.scaled:
        inverse = inverse * float(found.residual @ found.residual) / max(found.rows.count - len(size), 1)
    return replace(found.model, joint_covariance=inverse)
