"""Sub-Markov parameters: exact, by correlation, by least squares; each against products written out."""

import numpy as np
import pytest

from benchmarks.affine_plant import AffinePlant
from identification.errors import NotIdentifiableError, RangeError, ShapeError
from identification.varying.correlation_analysis import WhiteExcitation
from identification.varying.sub_markov import BasisSelection, ExactSubMarkov, SummedSubMarkov, every_word
from identification.varying.sub_markov_least_squares import WordRegression
from tests.support.random_state_space import random_affine, white_record


def exact(model):
    return ExactSubMarkov(model.a, model.b, model.c, model.d)


def with_constant(p):
    return np.column_stack([np.ones(len(p)), p])


def longer_words(columns, letter):
    return BasisSelection(tuple((letter, *word) for word in columns.words), columns.channels)


def everything(blocks):
    parts = (blocks.hankel, blocks.shifted, blocks.from_input, blocks.to_output, blocks.direct)
    return np.concatenate([part.ravel() for part in parts])


def test_exact_products_follow_the_words():
    m, _ = random_affine(np.random.default_rng(0), 3, 2, 2, 2)
    rows = BasisSelection(((1, 0, 2), (2,)), (1, 0))
    columns = BasisSelection(((2, 1, 0), (1,)), (0, 1))
    left = np.stack([(m.c[1] @ m.a[0] @ m.a[2])[1], m.c[2][0]])
    right = np.column_stack([(m.a[2] @ m.a[1] @ m.b[0])[:, 0], m.b[1][:, 1]])
    assert np.allclose(exact(m).hankel(rows, columns), left @ right, rtol=1e-12)
    blocks = exact(m).blocks(rows, columns)
    assert np.allclose(blocks.shifted[2], left @ m.a[2] @ right)
    assert np.allclose(blocks.from_input[1], left @ m.b[1])
    assert np.allclose(blocks.to_output[1], m.c[1] @ right)


def test_the_response_is_the_sum_over_words():
    rng = np.random.default_rng(1)
    model, _ = random_affine(rng, 2, 1, 1, 1)
    u, p = rng.standard_normal((6, 1)), rng.standard_normal((6, 1))
    psi, y = with_constant(p), model.simulate(u, p)
    first = BasisSelection(((0,), (1,)), (0, 0))
    expected = psi[5] @ model.d[:, 0, 0] * u[5, 0]
    for word in every_word(5, 2, 1).words:
        weight = np.prod([psi[4 - i, letter] for i, letter in enumerate(word)]) * u[5 - len(word), 0]
        g = exact(model).hankel(first, BasisSelection((word,), (0,)))[:, 0]
        expected += psi[5] @ g * weight
    assert y[5, 0] == pytest.approx(expected, rel=1e-12)


@pytest.fixture
def record():
    rng = np.random.default_rng(2)
    return white_record(random_affine(rng, 2, 2, 2, 2)[0], rng, 300, 20.0)


def test_correlation_is_the_mean_product_with_dual_signals(record):
    psi, n = with_constant(record.scheduling), 300
    rows, columns = BasisSelection(((1, 2),), (1,)), BasisSelection(((0, 1),), (0,))
    psi_dual = psi @ np.linalg.inv(psi.T @ psi / n)
    u = record.input - record.input.mean(axis=0)
    u_dual = u @ np.linalg.inv(u.T @ u / n)
    total = sum(
        record.output[t, 1] * psi_dual[t, 1] * psi_dual[t - 1, 2] * psi_dual[t - 2, 0] * psi_dual[t - 3, 1]
        * u_dual[t - 3, 0]
        for t in range(3, n)
    )  # fmt: skip
    found = WhiteExcitation(psi, record.input).fit(record.output).hankel(rows, columns)
    assert found == pytest.approx(total / (n - 3), rel=1e-10)


@pytest.mark.parametrize("method", ["correlation", "least squares"])
def test_blocks_are_the_products_of_longer_words(record, method):
    psi = with_constant(record.scheduling)
    fitter = WhiteExcitation(psi, record.input) if method == "correlation" else WordRegression(psi, record.input, 4)
    source = fitter.fit(record.output)
    rows = BasisSelection(((1,), (0, 2) if method == "correlation" else (2,)), (1, 0))
    columns = BasisSelection(((2, 1), (0,)), (1, 0))
    blocks = source.blocks(rows, columns)
    for letter in range(3):
        assert np.allclose(blocks.shifted[letter], source.hankel(rows, longer_words(columns, letter)))
        inputs = BasisSelection(((letter,), (letter,)), (0, 1))
        assert np.allclose(blocks.from_input[letter], source.hankel(rows, inputs))
        assert np.allclose(blocks.to_output[letter], source.hankel(inputs, columns))
    assert np.allclose(blocks.hankel, source.hankel(rows, columns))
    assert np.allclose(blocks.direct, source.direct())
    twice = SummedSubMarkov(source, source)
    assert np.allclose(everything(twice.blocks(rows, columns)), 2 * everything(blocks))
    assert np.allclose(twice.hankel(rows, columns), 2 * blocks.hankel)
    assert np.allclose(twice.direct(), 2 * blocks.direct)


def test_correlation_is_consistent_with_means_and_dependence_in_the_scheduling():
    rng = np.random.default_rng(4)
    model, _ = random_affine(rng, 2, 2, 2, 1, contraction=0.5)
    errors = []
    for n in (4_000, 64_000):
        p = rng.uniform(-1, 1, (n, 2)) @ np.array([[1.0, 0.6], [0.0, 0.8]]) + np.array([0.1, -0.2])
        u = rng.uniform(-1, 1, (n, 2)) @ np.array([[1.0, 0.5], [0.0, 1.0]]) + 0.3
        source = WhiteExcitation(with_constant(p), u).fit(model.simulate(u, p))
        rows, columns = every_word(1, 3, 1), every_word(1, 3, 2)
        expected = exact(model).blocks(rows, columns)
        difference = everything(source.blocks(rows, columns)) - everything(expected)
        errors.append(np.linalg.norm(difference) / np.linalg.norm(everything(expected)))
    assert errors[1] < 0.1
    assert 2.5 < errors[0] / errors[1] < 6.5


def short_response():
    """A model whose A_i A_j vanish: no word has more than three letters."""
    rng = np.random.default_rng(5)
    step = np.array([[0.0, 1.0], [0.0, 0.0]])
    a = rng.standard_normal((3, 1, 1)) * step
    return AffinePlant(
        a, rng.standard_normal((3, 2, 2)), rng.standard_normal((3, 2, 2)), rng.standard_normal((3, 2, 2)), 1.0
    )


def test_least_squares_is_exact_for_any_signals():
    model, rng = short_response(), np.random.default_rng(6)
    u = np.cumsum(rng.standard_normal((400, 2)), axis=0) * 0.2
    p = np.cumsum(rng.standard_normal((400, 2)), axis=0) * 0.1
    rows, columns = every_word(1, 3, 2), every_word(1, 3, 2)
    regression = WordRegression(with_constant(p), u)
    assert regression.size == 2 * (3 + 9 + 27)
    found = regression.fit(model.simulate(u, p)).blocks(rows, columns)
    assert np.allclose(everything(found), everything(exact(model).blocks(rows, columns)), atol=1e-9)
    shrunk = WordRegression(with_constant(p), u, ridge=1e-3).fit(model.simulate(u, p)).blocks(rows, columns)
    size = np.linalg.norm(everything(found))
    assert 1e-6 < np.linalg.norm(everything(shrunk) - everything(found)) < 0.5 * size


def test_bad_input_is_named(record):
    psi, u, y = with_constant(record.scheduling), record.input, record.output
    word = every_word(1, 3, 2)
    with pytest.raises(ShapeError):
        WhiteExcitation(psi[:-1], u)
    with pytest.raises(ShapeError):
        WhiteExcitation(psi, u).fit(y[:-1])
    with pytest.raises(NotIdentifiableError, match="linearly dependent"):
        WhiteExcitation(psi[:, [0, 1, 1]], u).fit(y).hankel(word, word)
    with pytest.raises(NotIdentifiableError, match="excite every input"):
        WhiteExcitation(psi, u * [1, 0]).fit(y).direct()
    long = every_word(3, 3, 2)
    with pytest.raises(NotIdentifiableError, match="too few for words"):
        WhiteExcitation(psi[:12], u[:12]).fit(y[:12]).hankel(long, long)
    with pytest.raises(ShapeError):
        WordRegression(psi[:-1], u)
    with pytest.raises(ShapeError):
        WordRegression(psi, u).fit(y[:-1])
    with pytest.raises(RangeError, match="needs two"):
        WordRegression(psi, u, 1)
    with pytest.raises(RangeError, match="ridge"):
        WordRegression(psi, u, ridge=-1.0)
    with pytest.raises(NotIdentifiableError, match="record longer"):
        WordRegression(psi, u, 5)
    with pytest.raises(NotIdentifiableError, match="excite more"):
        WordRegression(psi, u * [1, 0]).fit(y)
    with pytest.raises(RangeError, match="fit longer words"):
        WordRegression(psi, u).fit(y).hankel(every_word(2, 3, 2), every_word(2, 3, 2))
