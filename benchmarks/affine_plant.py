"""A plant whose state-space matrices are affine in the scheduling, simulated by its equations: the truth of studies."""

from dataclasses import dataclass, replace

import numpy as np

from identification.arrays import ComplexArray, FloatArray
from identification.bases.polynomial import Polynomial
from identification.errors import RangeError
from identification.models.model import Model
from identification.models.state_space_model import stacks, state_space_model
from identification.scheduling import ProductBasis, SchedulingVariable

Stacks = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class AffinePlant:
    """x(t+1) = A(p) x + B(p) u,  y = C(p) x + D(p) u with A(p) = A_0 + Σ_i A_i p_i [Goos2014, (1)–(3); Cox2018, (1)].

    `a` (1 + n_p, n_x, n_x), `b` (1 + n_p, n_x, n_u), `c` (1 + n_p, n_y, n_x), `d` (1 + n_p, n_y, n_u), constants first.
    """

    a: FloatArray
    b: FloatArray
    c: FloatArray
    d: FloatArray
    sample_time: float = 1.0
    variables: tuple[SchedulingVariable, ...] = ()

    @classmethod
    def of(cls, model: Model) -> "AffinePlant":
        """The plant that a model over 1, p_1, p_2, … describes."""
        functions = _places(model.dependence.bases[0])
        a, b, c, d = (part[functions] for part in stacks(model))
        return cls(a, b, c, d, model.structure.sample_time or 0.0, model.variables)

    def model(self, covariance: FloatArray | None = None) -> Model:
        """As a model; `covariance` of its θ. Variables that were not declared run from −1 to 1."""
        variables = self.variables or tuple(
            SchedulingVariable(f"p{i + 1}", "", -1.0, 1.0) for i in range(self.n_scheduling)
        )
        basis = ProductBasis((Polynomial(1),) * self.n_scheduling, total_degree=1)
        back = np.argsort(_places(basis))
        a, b, c, d = (part[back] for part in self.matrices)
        return state_space_model(variables, (basis,) * 4, (a, b, c, d), self.sample_time, covariance)

    @property
    def matrices(self) -> Stacks:
        """The stacks."""
        return self.a, self.b, self.c, self.d

    @property
    def order(self) -> int:
        """n_x."""
        return int(self.a.shape[1])

    @property
    def n_scheduling(self) -> int:
        """n_p, the constant not counted."""
        return len(self.a) - 1

    @property
    def n_inputs(self) -> int:
        """n_u."""
        return int(self.b.shape[2])

    @property
    def n_outputs(self) -> int:
        """n_y."""
        return int(self.c.shape[1])

    def eigenvalues(self) -> ComplexArray:
        """Those of each A_i, (1 + n_p, n_x)."""
        return np.asarray(np.linalg.eigvals(self.a), dtype=np.complex128)

    def transformed(self, basis: FloatArray) -> "AffinePlant":
        """The same input–output behaviour with the state x' = T⁻¹ x, T (n_x, n_x) = `basis`."""
        inverse = np.linalg.inv(np.asarray(basis, dtype=np.float64))
        return replace(self, a=inverse @ self.a @ basis, b=inverse @ self.b, c=self.c @ basis)

    def frozen(self, points: FloatArray) -> Stacks:
        """A, B, C, D at points or along p(t), (..., n_p): each (..., rows, columns)."""
        a, b, c, d = (part[0] + np.einsum("...i,iab->...ab", points, part[1:]) for part in self.matrices)
        return a, b, c, d

    def frequency_response(self, points: FloatArray, omega: FloatArray) -> ComplexArray:
        """C (zI − A)⁻¹ B + D at points (M, n_p) held still, ω (F,) in rad/s: (M, F, n_y, n_u)."""
        a, b, c, d = (part[:, None] for part in self.frozen(np.atleast_2d(points)))
        z = np.exp(1j * np.asarray(omega) * self.sample_time)[:, None, None]
        return np.asarray(c @ np.linalg.solve(z * np.eye(self.order) - a, b.astype(complex)) + d)

    def simulate(
        self, input: FloatArray, scheduling: FloatArray, initial_state: FloatArray | None = None
    ) -> FloatArray:
        """y (N, n_y) for u (N, n_u) along p (N, n_p), one sample after the other, from rest unless a state is given."""
        a, b, c, d = self.frozen(scheduling)
        x = np.zeros(self.order) if initial_state is None else initial_state
        output = np.empty((len(input), self.n_outputs))
        with np.errstate(over="ignore", invalid="ignore"):
            for t, u in enumerate(input):
                output[t] = c[t] @ x + d[t] @ u
                x = a[t] @ x + b[t] @ u
        if not np.all(np.isfinite(output)):
            raise RangeError("the simulated output grows beyond all numbers: the model is unstable along p(t)", "model")
        return output


def with_constant(scheduling: FloatArray) -> FloatArray:
    """1 and p(t) along p (N, n_p): the functions (N, 1 + n_p) of affine matrices."""
    return np.column_stack([np.ones(len(scheduling)), scheduling])


def _places(basis: ProductBasis) -> list[int]:
    """Where 1, p_1, p_2, … stand among products of degree one at most."""
    names = [label.split(",") for label in basis.labels]
    units = [["0"] * len(basis.factors)] + [
        ["1" if k == i else "0" for k in range(len(basis.factors))] for i in range(len(basis.factors))
    ]
    return [names.index(unit) for unit in units]
