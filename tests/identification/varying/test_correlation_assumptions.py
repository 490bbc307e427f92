"""Each breach of A1–A3 is seen, is seen alone, and is not seen where there is none."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import binom

from identification.varying.correlation_assumptions import (
    A1,
    A1_NORMAL,
    A2,
    A3,
    A3_INPUT,
    broken_assumptions,
    correlation_applies,
    noise_tests,
    signal_tests,
)

N = 2000


def coloured(x):
    return lfilter([1.0], [1.0, -0.3], x, axis=0)


def white(rng, samples=N):
    p = rng.choice([-0.9, 0.9], (samples, 2)) + 0.2
    return np.column_stack([np.ones(samples), p, rng.uniform(-1, 1, samples)]), rng.uniform(-1, 1, (samples, 2))


def broken(tests):
    return {test.name for test in tests if test.p_value < 1e-3}


def test_white_signals_pass():
    psi, u = white(np.random.default_rng(0))
    tests = signal_tests(psi, u)
    assert [test.name for test in tests] == [A2, A3, A3_INPUT]
    assert broken(tests) == set()
    assert correlation_applies(tests)
    assert broken_assumptions(tests, True) == ()


def breach(kind, rng):
    psi, u = white(rng)
    if kind == A2:
        return psi, coloured(u)
    if kind == "mean":
        return np.column_stack([psi[:, 0], coloured(psi[:, 1:])]), u
    if kind == "size":
        size = np.repeat(rng.choice([0.2, 1.0], N // 10), 10)
        return np.column_stack([psi[:, :3], psi[:, 3] * size]), u
    if kind == "both":
        return np.column_stack([psi[:, 0], coloured(psi[:, 1:])]), coloured(u)
    late = np.concatenate([np.zeros((3, 2)), u[:-3]])
    return np.column_stack([psi[:, :3], psi[:, 3] + 0.3 * late[:, 0]]), u


@pytest.mark.parametrize(("kind", "name"), [(A2, A2), ("mean", A3), ("size", A3), ("late input", A3_INPUT)])
def test_each_breach_is_seen_alone(kind, name):
    tests = signal_tests(*breach(kind, np.random.default_rng(1)))
    assert broken(tests) == {name}
    assert not correlation_applies(tests)
    (text,) = broken_assumptions(tests, True)
    assert f"({name[:2]})" in text
    assert "use least squares" in text
    assert "found by least squares" in broken_assumptions(tests, False)[0]


def test_coloured_signals_that_are_independent_are_not_taken_for_dependent_ones():
    assert broken(signal_tests(*breach("both", np.random.default_rng(5)))) == {A2, A3}


def test_noise_that_is_coloured_or_not_normal_is_seen():
    rng = np.random.default_rng(2)
    mix = np.array([[1.0, 0.8], [0.0, 0.4]])
    assert broken(noise_tests(rng.standard_normal((N, 2)) @ mix)) == set()
    assert broken(noise_tests(coloured(rng.standard_normal((N, 2))) @ mix)) == {A1}
    assert broken(noise_tests(rng.laplace(size=(N, 2)))) == {A1_NORMAL}
    assert "(A1)" in broken_assumptions(noise_tests(rng.laplace(size=(N, 2))), True)[0]


def test_the_levels_are_right():
    rng = np.random.default_rng(3)
    runs = 200
    values = []
    for _ in range(runs):
        psi, u = white(rng, 500)
        values.append([t.p_value for t in (*signal_tests(psi, u), *noise_tests(rng.standard_normal((500, 2))))])
    rejected = np.sum(np.array(values) < 0.05, axis=0)
    low, high = binom.interval(0.9995, runs, 0.05)
    assert np.all((rejected >= low) & (rejected <= high)), rejected


def test_constant_signals_are_left_out():
    psi, u = white(np.random.default_rng(4))
    assert [test.name for test in signal_tests(psi[:, :1], u)] == [A2]
    assert [test.name for test in signal_tests(psi, np.full((N, 1), 3.0))] == [A3]
    assert noise_tests(np.zeros((N, 2))) == ()
