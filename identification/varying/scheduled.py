"""Records along p(t) with the functions of a basis as their signals, and models over these functions."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from identification.arrays import FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError, NotIdentifiableError, ShapeError
from identification.models.model import Model
from identification.models.state_space import Matrices
from identification.models.state_space_model import charted, stacks, state_space_model
from identification.scheduling import ProductBasis, SchedulingVariable
from identification.varying.records import VaryingRecord
from identification.varying.stacks import StackSizes

WELL_CONDITIONED, ALIKE = 2.0, 1e-9


@dataclass(frozen=True, eq=False)
class Signals:
    """Input (N, n_u), output (N, n_y) and functions of the scheduling φ (N, k), the first of which is one."""

    input: FloatArray
    output: FloatArray
    phi: FloatArray

    def __len__(self) -> int:
        return len(self.input)

    def part(self, start: int, stop: int) -> "Signals":
        """Samples start … stop − 1."""
        cut = slice(start, stop)
        return Signals(self.input[cut], self.output[cut], self.phi[cut])


def affine(variables: int) -> ProductBasis:
    """1 and each scheduling variable."""
    return ProductBasis((Polynomial(1),) * variables, total_degree=1)


@dataclass(frozen=True, eq=False)
class Scheduled:
    """A record whose matrices are sums over functions ψ_j of a basis, none given: 1, p_1, p_2, …

        A(p) = Σ_j A_j ψ_j(p) = Σ_i A'_i φ_i(t),   φ(t) = Cᵀ ψ(p(t)),   A_j = Σ_i C_ji A'_i          [Cox2018, (1), (2)]

    Estimators see φ, with φ_1 = 1 and the others as unlike each other as numbers need: C = I where ψ is so, else they
    are of mean zero, mean square one and orthogonal along this record. `variables` that a record does not declare run
    over three times the range that it shows.
    """

    record: VaryingRecord
    variables: tuple[SchedulingVariable, ...]
    basis: ProductBasis
    change: FloatArray

    @classmethod
    def of(cls, record: VaryingRecord, basis: ProductBasis | None = None, start: Model | None = None) -> "Scheduled":
        """Of a record; a `start` states its basis and variables where nothing else does.

        Raises MisuseError for a basis of other variables, or none of whose combinations is constant, and
        NotIdentifiableError where p(t) does not tell its functions apart.
        """
        variables = record.variables or (_shown(record) if start is None else start.variables)
        if basis is None:
            basis = affine(len(variables)) if start is None else start.dependence.bases[0]
        if len(basis.factors) != record.scheduling.shape[1] or len(variables) != len(basis.factors):
            raise ShapeError(
                f"the basis has {len(basis.factors)} factors, the record {record.scheduling.shape[1]} scheduling"
                " signals; give one factor for each",
                "basis",
            )
        if not record.variables and start is None and basis != affine(len(variables)):
            raise MisuseError("declare the scheduling variables with their ranges, which the basis needs", "variables")
        psi = basis.evaluate(record.scheduling, variables)
        return cls(record, variables, basis, _change(psi))

    def at(self, scheduling: FloatArray) -> FloatArray:
        """φ (N, k) along p (N, n_p), stored signal by signal."""
        return np.asfortranarray(self.basis.evaluate(scheduling, self.variables) @ self.change)

    @cached_property
    def signals(self) -> Signals:
        """Those of the record."""
        return self.of_other(self.record)

    def of_other(self, record: VaryingRecord) -> Signals:
        """Those of another record in the same functions φ."""
        return Signals(record.input, record.output, self.at(record.scheduling))

    def matrices(self, model: Model, order: int) -> Matrices:
        """The stacks A'_i, … of a model of order n_x over the same functions; ShapeError or MisuseError for others."""
        found = stacks(model)
        sizes = StackSizes.of(found)
        needed = StackSizes(order, self.basis.size, self.record.input.shape[1], self.record.output.shape[1])
        if sizes != needed:
            raise ShapeError(f"the start has the sizes {sizes}, the record needs {needed}", "start")
        if model.dependence.variables != self.variables or set(model.dependence.bases) != {self.basis}:
            raise MisuseError(
                "the start has other scheduling variables or another basis; give one of the same", "start"
            )
        back = np.linalg.inv(self.change)
        a, b, c, d = (np.tensordot(back, part, 1) for part in found)
        return a, b, c, d

    def model(self, matrices: Matrices, covariance: FloatArray | None = None, noise: float = 1.0) -> Model:
        """The model of stacks over φ, with their covariance (size, size) and the variance of the noise."""
        a, b, c, d = (np.tensordot(self.change, part, 1) for part in matrices)
        bases, step = (self.basis,) * 4, self.record.sample_time
        found = state_space_model(self.variables, bases, (a, b, c, d), step, None, noise)
        if covariance is None:
            return found
        return charted(replace(found, covariance=self._covariance(found, covariance)))

    def _covariance(self, model: Model, covariance: FloatArray) -> FloatArray:
        """Of θ over ψ, among the state bases nearest to that of the model."""
        if np.array_equal(self.change, np.eye(len(self.change))):
            return covariance
        shapes = StackSizes.of(stacks(model)).shapes
        turned = block_diag(*(np.kron(self.change, np.eye(rows * columns)) for _, rows, columns in shapes))
        chart = charted(model).chart
        assert chart is not None, "state spaces have one"
        kept = chart @ (chart.T @ turned)
        return np.asarray(kept @ covariance @ kept.T)


def _shown(record: VaryingRecord) -> tuple[SchedulingVariable, ...]:
    ends = zip(record.scheduling.min(axis=0).tolist(), record.scheduling.max(axis=0).tolist(), strict=True)
    widths = [(low, high, (high - low) or 1.0) for low, high in ends]
    return tuple(
        SchedulingVariable(f"p{i + 1}", "", low - width, high + width) for i, (low, high, width) in enumerate(widths)
    )


def _change(psi: FloatArray) -> FloatArray:
    """C (k, k) for ψ (N, k)."""
    sizes = np.linalg.norm(psi, axis=0)
    if psi.shape[1] == 1 or (np.all(psi[:, 0] == 1) and _condition(psi, sizes) < WELL_CONDITIONED):
        return np.eye(psi.shape[1])
    scaled = psi / np.where(sizes > 0, sizes, 1.0)
    constant, *_ = np.linalg.lstsq(scaled, np.ones(len(psi)), rcond=None)
    if np.max(abs(scaled @ constant - 1)) > ALIKE:
        raise MisuseError(
            "no combination of the basis functions is constant along this record; take a basis with a constant", "basis"
        )
    mean = scaled.mean(axis=0)
    _, spread, directions = np.linalg.svd(scaled - mean, full_matrices=False)
    count = psi.shape[1] - 1
    if spread[count - 1] <= ALIKE * max(float(np.linalg.norm(scaled)), 1.0):
        raise NotIdentifiableError(
            f"this scheduling does not tell the {psi.shape[1]} basis functions apart; vary every scheduling variable"
            " over its range, or take fewer functions",
            "scheduling",
        )
    turned = directions[:count].T * (np.sqrt(len(psi)) / spread[:count])
    found = np.column_stack([constant, turned - np.outer(constant, mean @ turned)])
    return np.asarray(found / np.where(sizes > 0, sizes, 1.0)[:, None])


def _condition(psi: FloatArray, sizes: FloatArray) -> float:
    return float(np.linalg.cond(psi / sizes)) if np.all(sizes > 0) else np.inf
