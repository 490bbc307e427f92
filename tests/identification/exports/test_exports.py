"""Exports: the table is ζ(p) with its deviations, and compiled C plays what the model plays along p(t)."""

import csv
import io
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from identification.bases.b_spline import BSpline
from identification.bases.chebyshev import Chebyshev
from identification.bases.polynomial import Polynomial
from identification.errors import MisuseError
from identification.exports import exports
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable

ONE = (SchedulingVariable("speed", "rad/s", -2.0, 5.0),)
TWO = (*ONE, SchedulingVariable("load", "kg", 1.0, 3.0))
MAIN = """
#include <stdio.h>
int main(void)
{
    lpv_state s;
    double p[LPV_VARIABLES], u;
    lpv_reset(&s);
    for (;;) {
        for (int i = 0; i < LPV_VARIABLES; ++i) {
            if (scanf("%lf", &p[i]) != 1) {
                return 0;
            }
        }
        if (scanf("%lf", &u) != 1) {
            return 1;
        }
        printf("%.17g\\n", lpv_step(&s, p, u));
    }
}
"""


def model(structure: RationalStructure, variables: tuple[SchedulingVariable, ...], basis: ProductBasis) -> Model:
    dependence = ParameterDependence(variables, (basis,) * structure.size)
    generator = np.random.default_rng(4)
    theta = generator.normal(size=dependence.size) * 0.05
    root = generator.normal(size=(dependence.size, dependence.size)) * 1e-3
    return Model(structure, dependence, theta, root @ root.T, 1.0)


CASES = {
    "polynomial": model(RationalStructure(2, 1, 1, sample_time=0.1), ONE, ProductBasis((Polynomial(2),))),
    "long delay": model(RationalStructure(1, 0, 7, sample_time=0.1), ONE, ProductBasis((Chebyshev(3),))),
    "spline": model(RationalStructure(3, 2, 0, sample_time=0.1), ONE, ProductBasis((BSpline(3, (0.5, 2.0)),))),
    "two variables": model(
        RationalStructure(2, 1, 1, sample_time=0.1), TWO, ProductBasis((Polynomial(2), BSpline(1, (2.0,))), None)
    ),
    "no past output": model(RationalStructure(0, 3, 1, sample_time=0.1), ONE, ProductBasis((Polynomial(1),))),
    "noise model": model(RationalStructure(1, 1, 1, 1, 1, sample_time=0.1), ONE, ProductBasis((Polynomial(1),))),
}


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
@pytest.mark.parametrize("name", CASES)
def test_compiled_source_plays_what_the_model_plays(tmp_path: Path, name: str) -> None:
    case = CASES[name]
    (tmp_path / "model.c").write_text(exports()["c"].written(case) + MAIN, encoding="utf-8")
    flags = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off"]
    subprocess.run(["gcc", *flags, "model.c", "-o", "model"], cwd=tmp_path, check=True)
    generator = np.random.default_rng(9)
    low, high = (np.array([getattr(v, end) for v in case.dependence.variables]) for end in ("minimum", "maximum"))
    p = generator.uniform(low, high, (300, len(low)))
    p[:2] = low, high
    u = generator.normal(size=300)
    lines = "\n".join(" ".join(f"{value:.17g}" for value in (*row, sample)) for row, sample in zip(p, u, strict=True))
    done = subprocess.run(["./model"], cwd=tmp_path, input=lines, capture_output=True, text=True, check=True)
    expected = case.structure.along(case.coefficients(p), u[:, None]).output[:, 0]
    np.testing.assert_allclose(np.array(done.stdout.split(), dtype=float), expected, rtol=1e-9, atol=1e-12)
    assert "malloc" not in exports()["c"].written(case)


def test_the_table_holds_coefficients_and_deviations() -> None:
    case = CASES["spline"]
    rows = list(csv.DictReader(io.StringIO(exports()["coefficients"].written(case))))
    points = np.array([[float(row["speed"])] for row in rows])
    assert (points.min(), points.max()) == (-2.0, 5.0)
    zeta = case.coefficients(points)
    generator = np.random.default_rng(2)
    draws = generator.multivariate_normal(case.theta, case.covariance, 4000)
    for i, name in enumerate(case.structure.coefficient_names):
        np.testing.assert_array_equal([float(row[name]) for row in rows], zeta[:, i])
        drawn = np.std([case.dependence.coefficients(theta, points[::40])[:, i] for theta in draws], axis=0)
        np.testing.assert_allclose([float(row[f"sd_{name}"]) for row in rows[::40]], drawn, rtol=0.08)
    assert "sd_" not in exports()["coefficients"].written(
        replace(case, covariance=np.zeros((case.dependence.size,) * 2))
    )


def test_what_cannot_be_exported_says_why() -> None:
    continuous = model(RationalStructure(1, 0), ONE, ProductBasis((Polynomial(1),)))
    with pytest.raises(MisuseError, match="discrete time"):
        exports()["c"].written(continuous)
