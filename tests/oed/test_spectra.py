"""Families of spectra: what they offer for given prices is the best they have."""

from dataclasses import replace

import numpy as np
import pytest

import oed.spectra
import oed.targets
from identification.errors import RangeError
from identification.registry import discover
from oed.design import design
from oed.information import sensitivity
from oed.problem import DecisionTarget, DesignProblem
from oed.spectra.fir import FirSpectra, FirSpectrum
from oed.spectra.lines import LineSpectra, LineSpectrum
from oed.subject import Subject
from tests.support.random_models import paper_model, random_model

POINTS = np.array([[-0.5], [1.0], [2.5]])


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("kind", discover(oed.spectra))
def test_no_spectrum_is_worth_more_than_the_best(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    model = random_model(rng)
    pricing = (
        discover(oed.spectra)[kind].example().pricing(Subject.of(model), POINTS, None, model.structure.sample_time)
    )
    factor = rng.normal(size=(model.plant_size,) * 2)
    prices = factor @ factor.T
    offer = pricing.best(prices, np.zeros(len(pricing.places)), pricing.flat(), [np.eye(1)] * len(pricing.flat()))
    found = dict.fromkeys(range(len(pricing.places)), 0.0)
    for block in offer.blocks:
        worth = np.einsum("abij,ij->ab", block.information, prices)
        found[block.point] = max(found[block.point], float(np.linalg.eigvalsh(worth)[-1]))
    assert np.array(list(found.values())) == pytest.approx(offer.worth, rel=1e-9)
    for block in pricing.flat():
        assert np.einsum("abij,ij->", block.information, prices) <= offer.worth[block.point]


@pytest.mark.parametrize("kind", discover(oed.targets))
@pytest.mark.parametrize("family", discover(oed.spectra))
def test_every_target_is_met_by_every_family(kind: str, family: str) -> None:
    model = random_model(np.random.default_rng(12))
    model = replace(model, noise_variance=1e-3 * model.noise_variance) if family == "multisines" else model
    target = discover(oed.targets)[kind].example(model)
    spectra = discover(oed.spectra)[family].example()
    result = design(DesignProblem(model, np.linspace(-1, 3, 9)[:, None], (target,), spectra, 500_000))
    assert 0 <= result.gap <= (0.999 if family == "multisines" else 1e-4)
    assert max(result.least_energy, result.lower_bound) <= result.total_energy * (1 + 1e-9)
    if isinstance(target, DecisionTarget):
        assert [number for number, _ in result.decisions] == [0] * len(result.decisions)
        assert min(decision.power for _, decision in result.decisions) >= 0.9 - 1e-6
        return
    k = model.plant_size
    plant = np.zeros((k, k))
    for one in result.experiments:
        samples = 64 if family != "fir" else 4000
        indices, energies = one.spectrum.line_energies(samples, model.structure.sample_time or 1.0)
        omega = 2 * np.pi * indices / (samples * (model.structure.sample_time or 1.0))
        a = sensitivity(model, [one.operating_point], omega)[0]
        plant += ((a.T * energies) @ a.conj()).real
    for matrix in target.matrices(model)[:, :k, :k]:
        assert np.linalg.eigvalsh(plant - matrix)[0] >= -1e-6 * np.linalg.eigvalsh(plant)[-1]


def test_fir_density_is_even_and_keeps_its_energy() -> None:
    spectrum = FirSpectrum(np.array([2.0, 0.6, -0.3]), 0.5)
    omega = np.linspace(-np.pi, np.pi, 4001) / 0.5
    density = spectrum.density(omega)
    assert density == pytest.approx(spectrum.density(-omega))
    assert np.trapezoid(density, omega * 0.5) / (2 * np.pi) == pytest.approx(spectrum.energy)
    indices, energies = spectrum.line_energies(64, 0.5)
    assert energies.sum() == pytest.approx(2.0)
    assert energies[5] == pytest.approx(2 * spectrum.density(np.array([2 * np.pi * indices[5] / 32]))[0] / 64)


def test_lines_need_a_record_that_holds_them() -> None:
    spectrum = LineSpectrum(2 * np.pi * np.array([3, 7]) / 100, np.array([1.0, 2.0]), np.array([3, 7]), 100)
    indices, energies = spectrum.line_energies(300, 1.0)
    assert indices.tolist() == [9, 21]
    assert energies.tolist() == [1.0, 2.0]
    with pytest.raises(RangeError, match="multiple of 100"):
        spectrum.line_energies(150, 1.0)


def test_families_that_make_no_sense() -> None:
    with pytest.raises(RangeError, match="degree"):
        FirSpectra(-1)
    with pytest.raises(RangeError, match="between 0 and 1000"):
        FirSpectra(1001)
    with pytest.raises(RangeError, match="fewer samples per period"):
        LineSpectra(2**24).pricing(Subject.of(paper_model()), np.linspace(0, 8, 17)[:, None], None, 1.0)
    with pytest.raises(RangeError, match="no lines"):
        LineSpectra(1)
    with pytest.raises(RangeError, match="no line of the record"):
        LineSpectra(20).pricing(Subject.of(paper_model()), [[1.0]], (0.01, 0.02), 1.0)
