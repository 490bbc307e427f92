"""Series of arcs with positive elements: recovered exactly, kept positive, refused where they make no sense."""

from dataclasses import replace

import numpy as np
import pytest

from identification.errors import MisuseError
from identification.lti.rational_fit import RationalFit, relative_error
from identification.models.rational import RationalStructure
from identification.signals import FrequencyResponse

FIT = RationalFit(weighting="relative", relaxation=True)


def arcs(generator: np.random.Generator, count: int, extra: int) -> FrequencyResponse:
    """A random series of arcs with a resistor (extra ≥ 1) and an inductance (extra = 2)."""
    omega = np.geomspace(1e-3, 1e4, 90)
    x = 1j * omega
    poles = 10 ** (np.linspace(-2, 3, count + 2)[1:-1] + generator.uniform(-0.4, 0.4, count))
    residues = poles * generator.uniform(0.5, 2, count)
    response = np.sum(residues / (x[:, None] + poles), axis=1)
    return FrequencyResponse(omega, response + (0, 0.3, 0.3 + 1e-5 * x)[extra], (0.0,))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("extra", [0, 1, 2])
def test_arcs_are_recovered(seed, count, extra):
    data = arcs(np.random.default_rng(seed), count, extra)
    estimate = FIT.estimate(RationalStructure(count, count - 1 + extra), data)
    assert relative_error(estimate.model, data) < 1e-8
    free = RationalFit(weighting="relative").estimate(RationalStructure(count, count - 1 + extra), data)
    np.testing.assert_allclose(estimate.model.zeta, free.model.zeta, rtol=1e-5)


def test_residues_stay_positive_where_the_data_ask_for_others():
    omega = np.geomspace(0.01, 100, 50)
    data = FrequencyResponse(omega, 1 / (1j * omega + 1) - 0.9 / (1j * omega + 5), (0.0,))
    structure = RationalStructure(2, 1)
    model = FIT.estimate(structure, data).model
    poles = structure.poles(model.zeta)
    residues = np.polyval(model.zeta[2:], poles) / (poles - poles[::-1])
    assert np.all(np.isreal(poles))
    assert np.all(poles.real < 0)
    assert np.all(residues.real >= 0)
    assert relative_error(RationalFit(weighting="relative").estimate(structure, data).model, data) < 1e-8


@pytest.mark.parametrize(
    "structure",
    [RationalStructure(1, 1, sample_time=0.1), RationalStructure(1, 1, delay=True), RationalStructure(2, 0)],
)
def test_other_structures_are_refused(structure):
    data = arcs(np.random.default_rng(0), 2, 0)
    if structure.is_discrete:
        data = replace(data, frequencies=np.linspace(0.1, 30, 90), sample_time=0.1)
    with pytest.raises(MisuseError, match="positive residues"):
        FIT.estimate(structure, data)
