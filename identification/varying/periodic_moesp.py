"""Subspace identification of a state-space model from a record with periodic scheduling, in the time domain."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from identification.arrays import FloatArray
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.estimates import Estimate
from identification.models.recursion import propagate
from identification.models.state_space import Matrices
from identification.outcome import Outcome
from identification.scheduling import ProductBasis
from identification.varying.periodic_observability import common_basis, periodic_observability
from identification.varying.progress import Progress, silent
from identification.varying.records import TOLERANCE, VaryingRecord, scheduling_period
from identification.varying.scheduled import Scheduled, Signals
from identification.varying.stacks import along, simulated, stated_order

REGULARISATIONS = tuple(10.0**k for k in range(-8, 5))
AMBIGUOUS = 0.995


@dataclass(frozen=True)
class PeriodicMoesp:
    """Observability matrices at every phase of the scheduling, brought to one state basis [Goos2014, Section 2].

        O_t = M_t(p) S,   C(t) = first rows of O_t,   O_{t+1}↑ A(t) = O_t↓,   y = linear in B_i, D_i given A_i, C_i

    Assumes periodic scheduling of period T, any rich input, and white noise; the window d keeps T ≥ d > n_x. Each ν of
    `regularisations` gives a model; the one with the least squared simulation error on validation data, the last fifth
    of the record if no other data are given, is kept, with B_i and D_i from the whole record. No covariance comes with
    it; it can start `PeriodicLikelihood`.
    """

    kind: ClassVar[str] = "periodic_moesp"

    window: Annotated[int | None, "d, samples of past and future; when not given n_x + 3, at most T"] = None
    regularisations: Annotated[tuple[float, ...], "ν, relative to the kernel of the scheduling, tried one by one"] = (
        REGULARISATIONS
    )
    varying_output: Annotated[bool, "whether C depends on the scheduling"] = True
    tolerance: Annotated[float, "largest repetition error of the scheduling, relative to its variation"] = TOLERANCE
    selection_samples: Annotated[int, "samples at most that B and D are fitted to while ν is chosen"] = 5000

    def __post_init__(self) -> None:
        if not self.regularisations or min(self.regularisations) <= 0:
            raise RangeError("give at least one regularisation, all positive", "regularisations")
        if self.selection_samples < 10:
            raise RangeError("selection_samples must be ten or more", "selection_samples")

    def estimate(
        self,
        record: VaryingRecord,
        order: int | None,
        *,
        validation: VaryingRecord | None = None,
        basis: ProductBasis | None = None,
        progress: Progress = silent,
    ) -> Estimate:
        """The model of order n_x over the functions of a basis (1, p_1, p_2, …); `validation` starts from rest.

        The advice says which ν was chosen. Raises MisuseError for scheduling that is not periodic, RangeError for a
        window outside T ≥ d > n_x, NotIdentifiableError for records too short, excitation of too low a rank, or when no
        ν gives a model that can be simulated; and as `Scheduled.of`.
        """
        order = stated_order(order)
        period = scheduling_period(record, self.tolerance)
        window = self._window(order, period)
        scheduled = Scheduled.of(record, basis)
        whole, held_out = scheduled.signals, None if validation is None else scheduled.of_other(validation)
        fitted = whole if held_out is not None else whole.part(0, len(whole) - len(whole) // 5)
        weights = whole.phi[:period]
        observability = periodic_observability(fitted.input, fitted.output, period, window, order)
        scored, n_y = [], record.output.shape[1]
        for i, regularisation in enumerate(self.regularisations):
            progress(i / len(self.regularisations), f"regularisation {regularisation:g}")
            common = common_basis(observability.bases, weights, n_y, regularisation, self.varying_output)
            a, c = affine_dynamics(common.bases, weights, n_y, self.varying_output)
            error = self._validated(fitted, whole, held_out, a, c)
            if np.isfinite(error):
                scored.append((error, regularisation, a, c))
        if not scored:
            raise NotIdentifiableError(
                "no regularisation gives a model that is stable along this scheduling; choose another order or window,"
                " or record longer",
                "regularisations",
            )
        _, chosen, a, c = min(scored, key=lambda item: item[0])
        model = scheduled.model(with_inputs(a, c, whole))
        exact = common_basis(observability.bases, weights, n_y, min(self.regularisations), self.varying_output)
        advice = f"regularisation {chosen:g} was chosen" + self._ambiguity(exact.correlations, order)
        return Estimate(model, Outcome("converged", advice, len(scored)), ())

    @classmethod
    def example(cls) -> "PeriodicMoesp":
        """A small one, for the conformance tests."""
        return cls(varying_output=False)

    def _ambiguity(self, correlations: FloatArray, order: int) -> str:
        if len(correlations) <= order or correlations[order] < AMBIGUOUS:
            return ""
        remedy = ", or say varying_output=False if C does not vary" if self.varying_output else ""
        return (
            f"; the state basis is hardly determined (next canonical correlation {correlations[order]:.6f}): choose a"
            f" scheduling with more harmonics{remedy}"
        )

    def _window(self, order: int, period: int) -> int:
        window = min(order + 3, period) if self.window is None else self.window
        if not period >= window > order >= 1:
            raise RangeError(
                f"the window d = {window} must keep {period} ≥ d > {order}: at most the period of the scheduling in"
                " samples, more than the order",
                "window",
            )
        return window

    def _validated(
        self,
        fitted: Signals,
        record: Signals,
        validation: Signals | None,
        a: FloatArray,
        c: FloatArray,
    ) -> float:
        """The mean squared simulation error on validation data; inf for an unstable model."""
        part = fitted.part(0, min(len(fitted), self.selection_samples))
        try:
            matrices = with_inputs(a, c, part)
        except MisuseError:
            return np.inf
        if validation is not None:
            test, first = validation, 0
        else:
            first = max(len(fitted) - self.selection_samples // 5, 0)
            stop = min(len(record), len(fitted) + self.selection_samples)
            test, first = record.part(first, stop), len(fitted) - first
        with np.errstate(over="ignore", invalid="ignore"):
            error = simulated(matrices, test.input, test.phi)[1] - test.output
            return float(np.mean(error[first:] ** 2))


def affine_dynamics(
    bases: FloatArray, weights: FloatArray, n_y: int, varying_output: bool = True
) -> tuple[FloatArray, FloatArray]:
    """A_i (1 + n_p, n_x, n_x) and C_i (1 + n_p, n_y, n_x) of O_t (T, d n_y, n_x) in one basis, by least squares.

    Σ_i p_i(t) O_{t+1}↑ A_i = O_t↓,   Σ_i p_i(t) C_i = O_t's first rows,   all phases t at once
    """
    m, order = weights.shape[1], bases.shape[2]
    upper = np.roll(bases, -1, axis=0)[:, :-n_y]
    regressor = (weights[:, None, :, None] * upper[:, :, None, :]).reshape(-1, m * order)
    a = np.linalg.lstsq(regressor, bases[:, n_y:].reshape(-1, order), rcond=None)[0]
    known = weights if varying_output else weights[:, :1]
    c = np.zeros((m, n_y * order))
    c[: known.shape[1]] = np.linalg.lstsq(known, bases[:, :n_y].reshape(len(weights), -1), rcond=None)[0]
    return np.asarray(a.reshape(m, order, order)), np.asarray(c.reshape(m, n_y, order))


def with_inputs(a: FloatArray, c: FloatArray, record: Signals) -> Matrices:
    """The stacks with those A_i, C_i, and B_i, D_i (and the initial state) by linear least squares on a record.

    Raises NotIdentifiableError when the response of A_i grows beyond all numbers or the regressors are dependent.
    """
    m, order = a.shape[:2]
    n_y, n_u, count = c.shape[1], record.input.shape[1], len(record)
    at, _, ct, _ = along((a, a, c, c), record.phi)
    driven = (record.phi[:, :, None] * record.input[:, None, :]).reshape(count, -1)
    forcing = np.zeros((order, m * n_u, count, order))
    for i in range(order):
        forcing[i, :, :, i] = driven.T
    with np.errstate(over="ignore", invalid="ignore"):
        forced = propagate(at, forcing.reshape(-1, count, order), np.zeros(order))[:, :-1]
        free = propagate(at, np.zeros((order, count, order)), np.eye(order))[:, :-1]
        response = (ct @ np.concatenate([forced, free])[..., None])[..., 0]
    if not np.all(np.isfinite(response)):
        raise NotIdentifiableError("the dynamics found are unstable along this scheduling", "record")
    direct = np.eye(n_y)[:, None, None, :] * driven.T[None, :, :, None]
    columns = np.concatenate([response, direct.reshape(-1, count, n_y)]).reshape(-1, count * n_y).T
    solved = np.linalg.lstsq(columns, record.output.ravel(), rcond=1e-12)[0]
    size = order * m * n_u
    b = solved[:size].reshape(order, m, n_u).transpose(1, 0, 2)
    d = solved[size + order :].reshape(n_y, m, n_u).transpose(1, 0, 2)
    return a, b, c, d
