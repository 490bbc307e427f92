"""Both realisations are exact on exact sub-Markov parameters, and say so when they cannot be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.affine_plant import AffinePlant
from identification.errors import MisuseError, NotIdentifiableError, RangeError
from identification.varying.ho_kalman import (
    full_realisation,
    largest_entries,
    order_by_singular_values,
    reduced_realisation,
)
from identification.varying.sub_markov import BasisSelection, ExactSubMarkov, every_word
from tests.support.random_state_space import random_affine

seeds = st.integers(0, 2**32 - 1)


def exact(model):
    return ExactSubMarkov(model.a, model.b, model.c, model.d)


def largest_difference(found, model, rng):
    """Of the responses along a random p(t), relative to the largest output."""
    u = rng.standard_normal((200, model.n_inputs))
    p = rng.uniform(-1.0, 1.0, (200, model.n_scheduling))
    y = model.simulate(u, p)
    return abs(AffinePlant(*found.matrices).simulate(u, p) - y).max() / abs(y).max()


def selected(source, depth, channels, size):
    rows, columns = every_word(depth, *channels[:2]), every_word(depth, channels[0], channels[2])
    at_rows, at_columns = largest_entries(source.hankel(rows, columns), min(size, len(rows)), min(size, len(columns)))
    return rows.subset(at_rows), columns.subset(at_columns)


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(1, 4), st.integers(1, 3), st.integers(1, 3), st.integers(1, 3))
def test_both_are_exact_on_random_systems(seed, order, n_p, n_u, n_y):
    rng = np.random.default_rng(seed)
    model, _ = random_affine(rng, order, n_p, n_u, n_y)
    source = exact(model)
    bases = selected(source, 3, (n_p + 1, n_y, n_u), 14)
    for found in (full_realisation(source, (2, 3), order), reduced_realisation(source, *bases, order)):
        assert found.order == order
        assert largest_difference(found, model, rng) < 1e-8


@pytest.mark.parametrize("seed", range(5))
def test_the_size_of_the_paper(seed):
    rng = np.random.default_rng(seed)
    model, lyapunov = random_affine(rng)
    for p in rng.choice([-1.0, 1.0], (20, 5)):
        a = model.frozen(p)[0]
        assert np.linalg.eigvalsh(a.T @ lyapunov @ a - lyapunov).max() < 0
    source, every = exact(model), every_word(2, 6, 2)
    bases = selected(source, 2, (6, 2, 2), 10)
    blocks = source.blocks(*bases)
    assert len(every) ** 2 == 7056
    assert sum(part.size for part in (blocks.hankel, blocks.shifted, blocks.from_input, blocks.to_output)) == 940
    for found in (full_realisation(source), reduced_realisation(source, *bases)):
        assert found.order == 4
        assert largest_difference(found, model, rng) < 1e-8


def test_a_lower_order_is_an_approximation():
    rng = np.random.default_rng(3)
    model, _ = random_affine(rng, order=3)
    found = full_realisation(exact(model), order=2)
    assert found.order == 2
    assert 1e-3 < largest_difference(found, model, rng) < 1


def test_the_largest_entries_are_selected_once_each():
    matrix = np.array([[1.0, -9.0, 2.0], [0.0, 8.0, 3.0], [7.0, 0.5, 0.1]])
    rows, columns = largest_entries(matrix, 2, 2)
    assert rows.tolist() == [0, 1]
    assert columns.tolist() == [1, 0]
    with pytest.raises(RangeError, match="cannot be selected"):
        largest_entries(matrix, 4, 1)


def test_order_from_singular_values():
    assert order_by_singular_values(np.array([9.0, 5.0, 0.1, 0.08, 0.07, 1e-9])) == 2
    assert order_by_singular_values(np.array([3.0, 2.0, 1e-15, 1e-16])) == 2
    assert order_by_singular_values(np.array([3.0])) == 1
    with pytest.raises(NotIdentifiableError, match="all zero"):
        order_by_singular_values(np.zeros(4))


def test_ranks_and_sizes_that_do_not_suffice():
    source = exact(random_affine(np.random.default_rng(1), order=2)[0])
    one = BasisSelection(((0,), (1,), (2,)), (0, 0, 0))
    with pytest.raises(NotIdentifiableError, match="rank below 3"):
        reduced_realisation(source, one, one, 3)
    with pytest.raises(RangeError, match="at least that size"):
        reduced_realisation(source, one, one, 4)
    with pytest.raises(RangeError, match="need a letter"):
        full_realisation(source, (1, 1))
    with pytest.raises(NotIdentifiableError, match="rank below"):
        full_realisation(source, order=3)


def test_selections_that_make_no_sense():
    for words, channels in ((((0,),), ()), ((), ()), (((),), (0,)), (((-1,),), (0,)), (((0,),), (-1,))):
        with pytest.raises(MisuseError):
            BasisSelection(words, channels)
    source = exact(random_affine(np.random.default_rng(1), order=2)[0])
    good, beyond = BasisSelection(((5,),), (1,)), BasisSelection(((6,),), (0,))
    for rows, columns in ((good, beyond), (beyond, good), (good, BasisSelection(((0,),), (2,)))):
        with pytest.raises(RangeError, match="does not have"):
            source.hankel(rows, columns)
    with pytest.raises(RangeError, match="lower the depth"):
        every_word(8, 6, 2)
    with pytest.raises(RangeError, match="at least 1"):
        every_word(0, 6, 2)
