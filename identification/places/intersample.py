"""What a plant does between its samples, where its input is held from one to the next."""

import warnings
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import expm, logm

from identification.arrays import ComplexArray, FloatArray
from identification.comparison.batch import Batch
from identification.models.structure import Structure

OFFSETS = 8
UNLIKE = 1e-6


def between_samples(
    structure: Structure, zeta: FloatArray, step: float, x: FloatArray, held: FloatArray, repeats: bool = True
) -> tuple[FloatArray, FloatArray] | None:
    """x and ẋ (M, L·8) in the middles of eighths of each interval, from samples x and held inputs (M, L).

        ẇ = A w + B u, x = C w,   [e^{AT} …; 0 1] = exp([A B; 0 0] T),   w_k = O⁻¹ (x_k … x_{k+n−1} − Γ (u_k … ))

    with the matrices of every operating point from the logarithm of its sampled form, T = `step` [Ljung1999, Section
    4.3]. None where no plant in continuous time has these samples (a pole at or left of zero, a delay of more than one
    sample, a direct path), or where its state cannot be told from its output.
    """
    models = [_between(structure, one.tobytes(), step) for one in zeta]
    known = [one for one in models if one is not None]
    if len(known) < len(models):
        return None
    wholes = [model.whole(one, inputs, repeats) for model, one, inputs in zip(known, x, held, strict=True)]
    positions = [(model.positions @ whole).T.ravel() for model, whole in zip(known, wholes, strict=True)]
    rates = [(model.rates @ whole).T.ravel() for model, whole in zip(known, wholes, strict=True)]
    return np.stack(positions), np.stack(rates)


def is_followed(structure: Structure, zeta: FloatArray, batch: Batch) -> bool:
    """Whether the input of a batch keeps its value between samples and its plants can be followed there."""
    if batch.held is None or batch.held.hold != "zero":
        return False
    return all(_between(structure, one.tobytes(), batch.held.step) is not None for one in zeta)


@dataclass(frozen=True, eq=False)
class Between:
    """The motion of the plants of a batch between their samples, for lines of x and of what drives it (M, K)."""

    structure: Structure
    zeta: FloatArray
    batch: Batch

    def __call__(self, core: ComplexArray, drive: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """x and ẋ (M, L·8)."""
        x, held = self.batch.signal(core), self.batch.signal(drive)
        step = self.batch.sample_time or 1.0
        found = between_samples(self.structure, self.zeta, step, x, held, self.batch.repeats)
        assert found is not None, "asked of `is_followed` before"
        return found


@dataclass(frozen=True, eq=False)
class _Between:
    """One plant: its sampled matrices, what gives w_k from the samples that follow, and x, ẋ at the offsets."""

    sampled: FloatArray
    from_outputs: FloatArray
    from_inputs: FloatArray
    positions: FloatArray
    rates: FloatArray

    def whole(self, x: FloatArray, held: FloatArray, repeats: bool) -> FloatArray:
        """The states and the held input, (n + 1, L)."""
        n = len(self.from_outputs)
        ahead = np.stack([np.roll(signal, -i) for signal in (x, held) for i in range(n)])
        state = self.from_outputs @ ahead[:n] + self.from_inputs @ ahead[n:]
        for k in range(0 if repeats else 1 - n, 0):
            state[:, k] = self.sampled[:n, :n] @ state[:, k - 1] + self.sampled[:n, n] * held[k - 1]
        return np.vstack([state, held])


@lru_cache(maxsize=512)
def _between(structure: Structure, zeta: bytes, step: float) -> _Between | None:
    found = structure.sampled(np.frombuffer(zeta), step)
    if found is None:
        return None
    sampled, output = found
    powers, solving = _powers(sampled), _solving(sampled, output)
    if powers is None or solving is None:
        return None
    generator, moved = powers
    full = np.append(output, 0.0)
    return _Between(sampled, *solving, full @ moved, full @ generator @ moved / step)


def _powers(sampled: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """L = ln S (n, n) and S^{(i + ½)/8} (8, n, n) of a sampled matrix; None where they are not real."""
    found = logarithm(sampled)
    if found is None:
        return None
    return found, np.stack([expm(found * share) for share in (np.arange(OFFSETS) + 0.5) / OFFSETS])


def logarithm(sampled: FloatArray) -> FloatArray | None:
    """L = ln S of a sampled matrix (n, n); None where it is not real."""
    values, vectors = np.linalg.eig(sampled)
    if np.any(values == 0):
        return None
    if np.linalg.cond(vectors) < 1 / UNLIKE:
        found = (vectors * np.log(values.astype(np.complex128))) @ np.linalg.inv(vectors)
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = np.asarray(logm(sampled), dtype=np.complex128)
    usable = np.all(np.isfinite(found)) and np.max(abs(found.imag)) <= UNLIKE * np.max(abs(found.real))
    return np.asarray(np.real(found), dtype=np.float64) if usable else None


def _solving(sampled: FloatArray, output: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """w_k from x_k … x_{k+n−1} and the inputs held then, each (n, n)."""
    n = len(output)
    powers = [output]
    for _ in range(n - 1):
        powers.append(powers[-1] @ sampled[:n, :n])
    observed, markov = np.stack(powers), [float(row @ sampled[:n, n]) for row in powers]
    if np.linalg.cond(observed) > 1 / UNLIKE:
        return None
    inputs = np.zeros((n, n))
    for i in range(n):
        inputs[i, :i] = markov[:i][::-1]
    solved = np.asarray(np.linalg.inv(observed), dtype=np.float64)
    return solved, -solved @ inputs
