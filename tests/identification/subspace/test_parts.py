"""The numerical parts of the subspace methods, each against its definition."""

import numpy as np
import pytest
from scipy.linalg import subspace_angles

from identification.errors import MisuseError, NotIdentifiableError
from identification.subspace.compression import solve_compressed, triangle
from identification.subspace.dominant import dominant_left_vectors
from identification.subspace.noise import Noise
from identification.subspace.polynomials import OrthonormalPolynomials
from identification.subspace.transition import projected, transition_matrix


def graded(sizes, rows=12, columns=400, seed=0):
    g = np.random.default_rng(seed)
    left = np.linalg.qr(g.standard_normal((rows, rows)))[0][:, : len(sizes)]
    right = np.linalg.qr(g.standard_normal((columns, len(sizes))))[0]
    return left, (left * sizes) @ right.T


@pytest.mark.parametrize("exponent", [2, 7, 10, 13])
def test_dominant_vectors_of_graded_matrices(exponent):
    sizes = np.logspace(0, -exponent, 6)
    left, matrix = graded(sizes)
    found, values = dominant_left_vectors(matrix, 6)
    assert np.allclose(values[:6], sizes, rtol=10 ** (exponent - 14.0))
    assert subspace_angles(found, left).max() < 10 ** (exponent - 14.0)
    assert np.allclose(found.T @ found, np.eye(6))


def test_dominant_vectors_of_a_noisy_matrix():
    matrix = graded([5.0, 3.0, 1.0])[1] + 0.01 * np.random.default_rng(1).standard_normal((12, 400))
    left, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
    found, values = dominant_left_vectors(matrix, 3)
    assert subspace_angles(found, left[:, :3]).max() < 1e-10
    assert np.allclose(values, sizes)


def test_a_matrix_of_zeros_has_no_dominant_vectors():
    found, values = dominant_left_vectors(np.zeros((3, 7)), 2)
    assert found.shape == (3, 0)
    assert np.array_equal(values, np.zeros(3))


@pytest.mark.parametrize("span", [3.0, 0.01])
def test_polynomials_are_orthonormal_and_shift(span):
    z = np.exp(1j * span * np.sort(np.random.default_rng(0).random(40)))
    found = OrthonormalPolynomials.on(z, 9)
    assert np.allclose(np.real(found.values.conj() @ found.values.T) / 40, np.eye(9), atol=1e-13)
    assert np.allclose(z * found.values[:-1], (found.values.T @ found.shift[:, :-1]).T)
    assert np.linalg.norm(found.shift, 2) <= 1 + 1e-12
    assert np.allclose(found.values[0], 1)


def test_too_few_lines_for_the_polynomials():
    with pytest.raises(NotIdentifiableError, match="degree 3 only"):
        OrthonormalPolynomials.on(np.exp(1j * np.array([0.5, 1.0])), 6)


def test_total_least_squares_against_its_definition():
    g = np.random.default_rng(0)
    one, a = g.standard_normal((30, 3)), g.standard_normal((3, 3))
    noisy_one, two = one + 0.1 * g.standard_normal((30, 3)), one @ a + 0.1 * g.standard_normal((30, 3))
    found = transition_matrix(noisy_one, two, "total_least_squares")

    def cost(x):
        # The least ‖[N_1 N_2]‖² for a given A: rows of [O_1 O_2] [A; −I] weighted with (AᵀA + I)⁻¹.
        rest = noisy_one @ x - two
        return np.trace(rest @ np.linalg.solve(x.T @ x + np.eye(3), rest.T))

    for _ in range(20):
        assert cost(found + 1e-3 * g.standard_normal((3, 3))) > cost(found)
    assert np.allclose(transition_matrix(one, one @ a, "total_least_squares"), a)


@pytest.mark.parametrize("on_the_circle", [1 - 1e-15, 1.0, 1 + 1e-15])
def test_projection_moves_eigenvalues_that_are_not_inside_by_the_margin_only(on_the_circle):
    g = np.random.default_rng(1)
    poles = [0.5, 1.4, -2.5, on_the_circle]
    pair = 1.25 * np.array([[np.cos(1), np.sin(1)], [-np.sin(1), np.cos(1)]])
    a = np.zeros((6, 6))
    a[:4, :4], a[4:, 4:] = np.diag(poles), pair
    basis = g.standard_normal((6, 6))
    found = np.linalg.eigvals(projected(basis @ a @ np.linalg.inv(basis), margin=1e-3))
    expected = [0.5, 0.6, 0.0, 0.999, 0.75 * np.exp(1j), 0.75 * np.exp(-1j)]
    assert np.allclose(np.sort_complex(found), np.sort_complex(expected), atol=1e-9)


def test_compressed_least_squares_in_pieces():
    g = np.random.default_rng(2)
    x, y = g.standard_normal((4, 50000)) * np.array([[1], [1e6], [1e-6], [1]]), g.standard_normal((2, 50000))
    both = np.concatenate([x, y])
    factor = triangle([both[:, :3], both[:, 3:20000], both[:, 20000:]])
    assert np.allclose(abs(factor), abs(np.linalg.qr(both.T)[1]), rtol=1e-6, atol=1e-9)
    solution, regular = solve_compressed(factor, 4)
    assert regular
    assert np.allclose(solution, np.linalg.lstsq(x.T / abs(x).max(axis=1), y.T)[0] / abs(x).max(axis=1)[:, None])
    assert not solve_compressed(triangle([np.concatenate([x[:1], x[:1], y])]), 2)[1]


def test_k_of_noise_against_its_definition():
    g = np.random.default_rng(3)
    z = np.exp(1j * np.sort(g.uniform(0, np.pi, 30)))
    polynomials = OrthonormalPolynomials.on(z, 5)
    root = g.standard_normal((30, 6, 8)) + 1j * g.standard_normal((30, 6, 8))
    covariance = root @ root.conj().swapaxes(1, 2)
    variance = np.diagonal(covariance, axis1=1, axis2=2).real.reshape(30, 3, 2)
    k = Noise(variance**-0.5, covariance).factors(polynomials.values)
    sums = sum(covariance.reshape(30, 3, 2, 3, 2)[:, :, j, :, j] / 2 for j in range(2))
    phi = polynomials.values
    wanted = sum(np.kron(sums[i], np.outer(phi[:, i], phi[:, i].conj())).real for i in range(30)) / 30
    assert np.allclose(k @ k.T, wanted)
    separate = Noise(variance**-0.5).factors(polynomials.values)
    for output in range(3):
        wanted = np.real((phi * variance.mean(axis=2)[:, output]) @ phi.conj().T) / 30
        assert np.allclose(separate[output] @ separate[output].T, wanted)


def test_variances_that_leave_too_few_lines():
    z = np.exp(1j * np.linspace(0.1, 3, 20))
    variance = np.full((20, 1, 1), 1e-30)
    variance[0] = 1.0
    with pytest.raises(MisuseError, match="differ so much"):
        Noise(variance**-0.5).factors(OrthonormalPolynomials.on(z, 6).values)
