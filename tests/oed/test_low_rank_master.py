"""The master problem on Gram matrices: agrees with the general conic solver, and says when it does not get there."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import oed.master
from identification.arrays import FloatArray
from oed.design import design
from oed.low_rank_master import solve_low_rank
from oed.master import MasterSolution, solve_master
from oed.spectra.family import Block
from oed.spectra.lines import LineSpectra
from tests.oed.test_design import random_problem


@pytest.fixture
def general() -> Iterator[None]:
    kept, oed.master.MOST_GENERAL = oed.master.MOST_GENERAL, 10**6
    yield
    oed.master.MOST_GENERAL = kept


def drawn(k: int, n: int, targets: int, parts: tuple[slice, ...], seed: int) -> tuple[list[Block], FloatArray]:
    rng = np.random.default_rng(seed)
    blocks = []
    for i in range(n):
        columns = rng.normal(size=(k, int(rng.integers(1, 4)))) * 10 ** rng.uniform(-2, 1)
        blocks.append(Block(i, np.zeros((1, 1)), within(columns @ columns.T, parts)[None, None], parts, columns))
    asked = []
    for _ in range(targets):
        factor = rng.normal(size=(k, k))
        asked.append(within(factor @ factor.T / k - rng.uniform(0, 0.4) * np.eye(k), parts))
    return blocks, np.stack(asked)


def within(matrix: FloatArray, parts: tuple[slice, ...]) -> FloatArray:
    result = np.zeros_like(matrix)
    for part in parts:
        result[part, part] = matrix[part, part]
    return result


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("k", "n", "targets", "parts"),
    [(4, 12, 1, (slice(0, 4),)), (11, 60, 3, (slice(0, 5), slice(5, 11))), (16, 90, 1, (slice(0, 16),))],
)
@pytest.mark.usefixtures("general")
def test_agrees_with_the_general_solver(k: int, n: int, targets: int, parts: tuple[slice, ...], seed: int) -> None:
    blocks, asked = drawn(k, n, targets, parts, seed)
    found = solve_low_rank(blocks, asked, 1e-9)
    expected: MasterSolution = solve_master(blocks, asked, np.full(n, np.inf))
    assert found.solved
    assert found.weights.sum() == pytest.approx(sum(weight[0, 0] for weight in expected.weights), rel=1e-6)
    total = np.einsum("n,nab->ab", found.weights, np.array([block.information[0, 0] for block in blocks]))
    assert min(np.linalg.eigvalsh(total - target)[0] for target in asked) >= -1e-9
    assert found.weights.min() >= 0
    worth = np.einsum("nab,jab->n", np.array([block.information[0, 0] for block in blocks]), found.prices)
    assert worth.max() <= 1 + 1e-9
    assert np.sum(found.prices * asked) == pytest.approx(found.weights.sum(), rel=1e-6)
    assert min(np.linalg.eigvalsh(price)[0] for price in found.prices) >= -1e-12


def test_what_cannot_be_met_is_not_called_solved() -> None:
    blocks, asked = drawn(4, 2, 1, (slice(0, 4),), 5)
    flat = [Block(one.point, one.shapes, one.information, one.parts, one.columns[:, :1]) for one in blocks[:1]]  # type: ignore[index]
    assert not solve_low_rank(flat, asked + np.eye(4), 1e-9).solved


@pytest.mark.parametrize("seed", [100, 103, 105])
def test_designs_are_the_same_by_both(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    problem = replace(random_problem(seed), family=LineSpectra(200), caps=None)
    one = design(problem)
    monkeypatch.setattr(oed.master, "MOST_GENERAL", 0)
    other = design(problem)
    assert other.outcome.ok
    assert other.total_energy == pytest.approx(one.total_energy, rel=2e-4)
