"""State-space models of any number of inputs and outputs."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from identification.arrays import ComplexArray, FloatArray, IntArray, require_positive
from identification.errors import MisuseError, RangeError
from identification.models.recursion import propagate
from identification.models.structure import NOT_ALONG, Along, Group, Structure

Matrices = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
MULTIPLE = 1e8
ON_A_POLE = "a frequency is that of a pole on the border of stability; leave it out"


@dataclass(frozen=True)
class StateSpaceStructure(Structure):
    """G = C (zI − A)⁻¹ B + D with all entries free, ζ = (A, B, C, D), each row by row; z = e^{jωT}, or jω.

    n_x states, `sample_time` T in seconds, None for continuous time. ζ of another state basis answers alike.
    """

    n_x: int
    n_u: int = 1
    n_y: int = 1
    sample_time: float | None = None

    def __post_init__(self) -> None:
        if min(self.n_x, self.n_u - 1, self.n_y - 1) < 0:
            raise RangeError("a state space has an order of zero or more, one input and one output at least", "order")
        if self.sample_time is not None:
            require_positive(self.sample_time, "sample time")

    @property
    def order(self) -> int:
        """n_x."""
        return self.n_x

    @property
    def outputs(self) -> int:
        """n_y."""
        return self.n_y

    @property
    def inputs(self) -> int:
        """n_u."""
        return self.n_u

    @property
    def shapes(self) -> tuple[tuple[int, int], ...]:
        """Of A, B, C and D."""
        n = self.order
        return (n, n), (n, self.n_u), (self.n_y, n), (self.n_y, self.n_u)

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """A, B, C, D with entries such as A(2,1)."""
        names = (
            (name, tuple(f"{name}({i + 1},{k + 1})" for i in range(rows) for k in range(columns)))
            for name, (rows, columns) in zip("ABCD", self.shapes, strict=True)
        )
        return tuple(Group(name, entries) for name, entries in names)

    def matrices(self, zeta: FloatArray) -> Matrices:
        """A (…, n_x, n_x), B (…, n_x, n_u), C (…, n_y, n_x), D (…, n_y, n_u) of ζ (…, n)."""
        ends = np.cumsum([rows * columns for rows, columns in self.shapes])[:-1]
        parts = np.split(zeta, ends, axis=-1)
        a, b, c, d = (part.reshape(*zeta.shape[:-1], *s) for part, s in zip(parts, self.shapes, strict=True))
        return a, b, c, d

    def response(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """C R B + D with R = (zI − A)⁻¹."""
        state, _ = self._parts(zeta, omega)
        _, _, c, d = (part[..., None, :, :] for part in self.matrices(zeta))
        return np.asarray(c @ state + d)

    def gradient(self, zeta: FloatArray, omega: FloatArray) -> ComplexArray:
        """C R e_i e_kᵀ R B for A(i,k), C R e_i for B(i,·), e_kᵀ R B for C(·,k), one for D."""
        state, through = self._parts(zeta, omega)
        by_a = np.einsum("...yi,...ku->...yuik", through, state)
        by_b = np.einsum("...yi,uv->...yuiv", through, np.eye(self.n_u))
        by_c = np.einsum("yz,...ku->...yuzk", np.eye(self.n_y), state)
        one = np.einsum("yz,uv->yuzv", np.eye(self.n_y), np.eye(self.n_u))
        by_d = np.broadcast_to(one, (*by_a.shape[:-4], *one.shape))
        return np.concatenate([part.reshape(*part.shape[:-2], -1) for part in (by_a, by_b, by_c, by_d)], axis=-1)

    def channel_response(self, zeta: FloatArray, omega: FloatArray, channels: IntArray) -> ComplexArray:
        """C_i R B_k + D_ik, nothing computed of other channels."""
        one, places = self._of_one(channels)
        return one.response(np.take_along_axis(zeta, places, axis=1), omega)[..., 0, 0]

    def channel_gradient(self, zeta: FloatArray, omega: FloatArray, channels: IntArray) -> ComplexArray:
        """As that of `channel_response`, zero by the entries of other channels."""
        one, places = self._of_one(channels)
        known = one.gradient(np.take_along_axis(zeta, places, axis=1), omega)[..., 0, 0, :]
        found = np.zeros((len(zeta), self.n_plant, len(omega)), dtype=np.complex128)
        np.put_along_axis(found, places[:, :, None], np.swapaxes(known, 1, 2), axis=1)
        return found

    def _of_one(self, channels: IntArray) -> tuple["StateSpaceStructure", IntArray]:
        """The structure of one input and output, and where its entries stand in ζ for each of the channels (M, ·)."""
        a, b, c, d = self.matrices(np.arange(self.size, dtype=np.float64))
        parts = [np.concatenate([a.ravel(), b[:, k], c[i], [d[i, k]]]) for i, k in channels.tolist()]
        return replace(self, n_u=1, n_y=1), np.array(parts).astype(np.int64)

    def poles(self, zeta: FloatArray) -> ComplexArray:
        """Eigenvalues of A."""
        return np.asarray(np.linalg.eigvals(self.matrices(zeta)[0]), dtype=np.complex128)

    def pole_gradient(self, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """dλ = w* dA v / w* v,  A v = λ v,  w* A = λ w* [Goos2014, Section 5]."""
        values, right = np.linalg.eig(self.matrices(zeta)[0])
        gradient = np.zeros((*values.shape, self.size), dtype=np.complex128)
        by_a = np.einsum("...la,...bl->...lab", np.linalg.pinv(right), right)
        gradient[..., : self.order**2] = by_a.reshape(*values.shape, -1)
        gradient[np.linalg.cond(right) > MULTIPLE] = np.inf
        return np.asarray(values, dtype=np.complex128), gradient

    def along(self, zeta: FloatArray, input: FloatArray) -> Along:
        """x(t+1) = A x + B u,  y = C x + D u;  δx(t+1) = A δx + δA x + δB u,  δy = C δx + δC x + δD u."""
        if not self.is_discrete:
            raise MisuseError(NOT_ALONG, "model")
        (a, b, c, d), u, rest = self.matrices(zeta), input[:, :, None], np.zeros(self.order)
        with np.errstate(over="ignore", invalid="ignore"):
            x = propagate(a, (b @ u)[..., 0], rest)[:-1, :, None]
            output = (c @ x + d @ u)[..., 0]

        def change(moved: FloatArray) -> FloatArray:
            da, db, dc, dd = self.matrices(moved)
            dx = propagate(a, (da @ x + db @ u)[..., 0], rest)[:-1, :, None]
            return np.asarray((c @ dx + dc @ x + dd @ u)[..., 0])

        return Along(np.asarray(output), change)

    def gauge(self, zeta: FloatArray) -> FloatArray:
        """Changes of the state basis x' = (I + εE)⁻¹ x, E one unit after the other [Goos2014, (10)].

        dA = A E − E A,   dB = −E B,   dC = C E,   dD = 0
        """
        a, b, c, d = (part[..., None, :, :] for part in self.matrices(zeta))
        units = np.eye(self.order**2).reshape(-1, self.order, self.order)
        still = np.zeros((*zeta.shape[:-1], len(units), *d.shape[-2:]))
        parts = (a @ units - units @ a, -units @ b, c @ units, still)
        return np.swapaxes(np.concatenate([part.reshape(*part.shape[:-2], -1) for part in parts], axis=-1), -1, -2)

    def _parts(self, zeta: FloatArray, omega: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """R B (…, F, n_x, n_u) and C R (…, F, n_y, n_x)."""
        a, b, c, _ = (part[..., None, :, :] for part in self.matrices(zeta))
        s = 1j * np.asarray(omega, dtype=np.float64)[:, None, None]
        z = s if self.sample_time is None else np.exp(s * self.sample_time)
        try:
            resolvent = np.linalg.inv(z * np.eye(self.order) - a)
        except np.linalg.LinAlgError as error:
            raise RangeError(ON_A_POLE, "frequencies") from error
        return np.asarray(resolvent @ b), np.asarray(c @ resolvent)
