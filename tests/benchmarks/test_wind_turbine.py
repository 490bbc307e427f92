"""The study of the wind turbine, made small."""

import numpy as np

from benchmarks.wind_turbine import NAMES, Runs, batch, bound, coverage, efficiency, summary, three_eigenvalues
from benchmarks.wind_turbine_pictures import Cloud, ellipse, pictures
from benchmarks.wind_turbine_plant import PLANT

TRUTH, _ = three_eigenvalues(PLANT.model())


def test_figures_and_pictures_of_a_few_runs() -> None:
    runs = batch("white", 0.06, 5, 3, np.random.SeedSequence(1))
    found = summary("white", runs, 0.06, 1.0)
    assert found["converged"] == 3
    assert 99.99 < found["VAF in %, mean"] <= 100
    assert len(found["inside the 95 % Cramér–Rao ellipses"]) == 3
    figure = pictures({NAMES["white"]: Cloud(runs.fits, runs.eigenvalues, bound("white", 0.06)[2])}, TRUTH, 0.06)
    assert [len(trace.x) for trace in figure.data] == [3, 3, 200, 1, 3, 1]


def test_efficiency_and_coverage_of_estimates_drawn_from_the_bound() -> None:
    generator = np.random.default_rng(2)
    covariance, chart, ellipses = bound("white", 0.06)
    inner = chart.T @ covariance @ chart
    errors = generator.standard_normal((4000, len(inner))) @ np.linalg.cholesky(inner).T
    assert abs(efficiency(errors, inner)["covariance over Cramér–Rao bound, mean of 14 directions"] - 1) < 0.03
    assert abs(efficiency(2 * errors, inner)["covariance over Cramér–Rao bound, mean of 14 directions"] - 4) < 0.12
    parts = generator.standard_normal((4000, 2)) @ np.linalg.cholesky(ellipses[0]).T
    real = generator.standard_normal((4000, 2)) * np.sqrt(ellipses[1:, 0, 0])
    eigenvalues = TRUTH + np.column_stack([parts @ [1, 1j], real])
    for size in (1.0, 1.1):
        drawn = TRUTH + size * (eigenvalues - TRUTH)
        runs = Runs(errors, drawn, np.broadcast_to(ellipses, (4000, 3, 2, 2)), np.zeros(4000), 4000)
        assert coverage(runs, ellipses)["all shares within it"] is (size == 1.0)
    x, y = ellipse(0j, ellipses[0])
    distances = np.einsum("ni,ij,nj->n", np.stack([x, y], 1), np.linalg.inv(ellipses[0]), np.stack([x, y], 1))
    assert np.allclose(distances, -2 * np.log(0.05))
