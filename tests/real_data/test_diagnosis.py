"""The diagnosis on measurements of others: a battery and a motor bench, whose missing effects are known."""

from pathlib import Path

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.comparison.gather import gather
from identification.diagnosis.staircase import staircase
from identification.effects.library import library
from identification.extension.model import ExtendedModel
from identification.lti.rational_fit import RationalFit
from identification.models import LpvModel, RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import FrequencyResponse

BATTERY = "../shared/data/eis_battery_13_states_of_charge/imiev_15C_eis.csv"
MOTOR = "../shared/data/motor_bench_flexible_coupling/frf_type{}_iq_to_theta.csv"
CIRCUIT = RationalStructure(1, 1, frequency_scale=10.0)
CHARGE = SchedulingVariable("state of charge", "%", 0.0, 100.0)


def table(repository: Path, name: str) -> np.ndarray:
    """The measured data, or a skip that says so."""
    file = repository / name
    if not file.exists():
        pytest.skip(f"the measured data are not here: {file}")
    return np.genfromtxt(file, delimiter=",", names=True)


def dependence(variable, degree, size):
    return ParameterDependence((variable,), tuple(ProductBasis((Polynomial(degree),)) for _ in range(size)))


@pytest.fixture(scope="module")
def spectra(repository: Path) -> list[FrequencyResponse]:
    data = table(repository, BATTERY)
    found = []
    for charge in np.unique(data["soc_pct"]):
        rows = data[data["soc_pct"] == charge]
        impedance = rows["Zre_ohm"] + 1j * rows["Zim_ohm"]
        found.append(FrequencyResponse(2 * np.pi * rows["freq_Hz"], impedance, (float(charge),)))
    return found


def circuit(spectra, degree):
    """A resistance and one RC arc, as polynomials in the state of charge through the local fits."""
    fit = RationalFit(weighting="relative", relaxation=True)
    local = [fit.estimate(CIRCUIT, one).model.zeta for one in spectra]
    how = dependence(CHARGE, degree, 3)
    stacked = how.matrix([one.operating_point for one in spectra]).reshape(-1, how.size)
    theta = np.linalg.lstsq(stacked, np.concatenate(local), rcond=None)[0]
    return ExtendedModel(LpvModel(CIRCUIT, how, theta, np.eye(how.size), 1.0))


def added(step):
    return [one.effect.kind for one in step.model.effects]


def announced(step):
    return {one.score.candidate.effect.kind for one in step.diagnosis.announced}


def test_the_battery_at_half_charge(spectra):
    """34.8 % → inductance 21.9 % → a second arc 10.0 % → diffusion 7.9 %, nothing left out of the impedance library."""
    half = [one for one in spectra if one.operating_point == (50.0,)]
    steps = staircase(circuit(half, 0), gather(half), effects=library("impedance"), largest=4)
    assert [100 * step.error for step in steps] == pytest.approx([34.8, 21.9, 10.0, 7.9], abs=0.1)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]
    assert announced(steps[0]) == {"inductance", "lead", "lossy_inductance"}
    assert announced(steps[1]) == {"rc_arc", "cpe_arc", "warburg_short"}
    inductance = steps[3].model.effects[0].coefficients[0, 0]
    assert inductance == pytest.approx(78e-9, rel=0.03)


def test_the_battery_with_the_effects_of_all_domains(spectra):
    half = [one for one in spectra if one.operating_point == (50.0,)]
    steps = staircase(circuit(half, 0), gather(half), largest=3)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]


def test_the_battery_over_all_states_of_charge(spectra):
    """The same order jointly; the inductance does not depend on the state of charge."""
    steps = staircase(circuit(spectra, 4), gather(spectra), effects=library("impedance"), degree=1, largest=3)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]
    assert [100 * step.error for step in steps] == pytest.approx([36.3, 24.2, 11.7, 9.4], abs=0.1)
    constant, slope = steps[3].model.effects[0].coefficients[0]
    assert constant == pytest.approx(78e-9, rel=0.03)
    assert abs(slope) < 0.02 * constant


@pytest.mark.parametrize(("kind", "before", "after"), [("A", 93.3, (13.9, 9.05)), ("B", 89.3, (12.9, 5.85))])
def test_the_motor_bench_misses_a_resonance_and_then_a_delay(repository, kind, before, after):
    data = table(repository, MOTOR.format(kind))
    response = data["Gm_re"] + 1j * data["Gm_im"]
    measured = FrequencyResponse(2 * np.pi * data["freq_Hz"], response, (0.0,))
    structure = RationalStructure(2, 0, frequency_scale=2 * np.pi * 50)
    gain = np.median(abs(response) * measured.frequencies**2) / structure.frequency_scale**2
    variable = SchedulingVariable("p", "1", -1.0, 1.0)
    model = LpvModel(structure, dependence(variable, 0, 3), np.array([0.02, 0.02, gain]), np.eye(3), 1.0)
    steps = staircase(ExtendedModel(model), gather([measured]), effects=library("mechanical"), largest=2)
    assert [100 * step.error for step in steps] == pytest.approx([before, *after], abs=0.1)
    assert added(steps[2]) == ["resonance", "delay"]
    assert steps[1].model.effects[0].effect.frequency / (2 * np.pi) == pytest.approx(76.2, abs=0.3)
    assert steps[2].model.effects[1].coefficients[0, 0] == pytest.approx(0.12e-3, rel=0.06)
