"""The measured output in the law: forces of any strength from linear equations, and what else may stand in them."""

import dataclasses

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.diagnosis.measured_law import Nuisance, measured_fit
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_stiffness import CubicStiffness
from identification.extension.fit import fit
from identification.extension.rows import Rows
from identification.models.physical import Coefficient, PhysicalForm
from identification.places.placed import placed
from tests.support.oscillators import MODEL, POINTS, THETA, batches, integrated, phasors, records

SIGMA = 1e-3
PHYSICAL = PhysicalForm((Coefficient("J"), Coefficient("d"), Coefficient("c")), (Coefficient("k", fixed=2.0),))


def measured(force, seed=3, level=8.0):
    g = np.random.default_rng(seed)
    inputs = [phasors(g, level) for _ in POINTS]
    return gather(records([(a, integrated(p, a, force)) for p, a in zip(POINTS, inputs, strict=True)], g, SIGMA))


@pytest.mark.parametrize(
    ("effect", "force", "e"),
    [
        (CubicStiffness(), lambda x, v: 100.0 * x**3, 100.0),
        (CubicStiffness(), lambda x, v: -3.0 * x**3, -3.0),
        (CoulombFriction(), lambda x, v: 3.0 * np.tanh(v / 1e-3), 3.0),
    ],
)
def test_strong_forces_come_out_of_linear_equations(effect, force, e):
    """Found without one simulation, and then the start of the exact fit."""
    rows = Rows(measured(force))
    found = measured_fit(MODEL.plus(placed(effect, 0, 1)), rows)
    assert found.outcome.ok
    assert found.model.parameters[-1] == pytest.approx(e, rel=0.04)
    assert found.model.parameters[:-1] == pytest.approx(THETA, rel=0.03)
    exact = fit(found.model, rows, start=found.flows)
    assert exact.model.parameters[-1] == pytest.approx(e, rel=0.025)
    assert exact.residual @ exact.residual < 0.02 * np.sum(fit(MODEL, rows).residual ** 2)


def test_columns_of_no_interest_are_taken_out_record_by_record():
    """A polynomial in jω over A stands for an initial state: what is put in as one does not move the parameters."""
    (batch,) = batches(5, SIGMA)
    g = np.random.default_rng(0)
    x = 1j * batch.omega
    denominator = (30 + 10 * batch.points) - batch.omega**2 + 1.5 * x
    spoilt = g.standard_normal((5, 1)) * 0.3 / denominator + g.standard_normal((5, 1)) * 0.05 * x / denominator
    with_state = Rows((dataclasses.replace(batch, outputs=batch.outputs + spoilt),))
    columns = np.stack([np.ones((5, len(x)), dtype=complex), np.tile(x, (5, 1))])
    plain = measured_fit(MODEL, with_state)
    free = measured_fit(MODEL, with_state, [Nuisance(columns)])
    assert plain.residual @ plain.residual > 100 * with_state.count
    assert free.residual @ free.residual < 1.2 * with_state.count
    assert free.model.parameters == pytest.approx(THETA, rel=0.01)


@pytest.mark.parametrize("structure", [MODEL.structure, PHYSICAL])
def test_the_characteristic_polynomial_is_what_makes_the_equation_linear(structure):
    """A and A G are both sums over the coefficients: their second differences by any of them vanish."""
    omega = np.array([0.5, 2.0, 7.0])
    zeta = np.linspace(1.0, 2.0, structure.size)
    a = structure.characteristic(zeta, omega)
    for i in range(structure.size):
        step = 0.1 * np.eye(structure.size)[i]
        ends = [structure.characteristic(zeta + side * step, omega)[0] for side in (1, -1)]
        slope = a[1 + i] if i < len(a) - 1 else 0.0
        assert (ends[0] - ends[1]) / 0.2 == pytest.approx(slope, abs=1e-9)
        products = [
            structure.characteristic(zeta + side * step, omega)[0] * structure.plant_response(zeta + side * step, omega)
            for side in (1, 0, -1)
        ]
        assert products[0] - 2 * products[1] + products[2] == pytest.approx(0.0, abs=1e-9)
