"""The diagnosis on measurements of others: a battery and a motor bench, whose missing effects are known."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks import battery, motor_bench
from identification.comparison.gather import gather
from identification.diagnosis.staircase import staircase
from identification.signals import FrequencyResponse


def folder(repository: Path, name: str, file: str) -> Path:
    """Where measured data are, or a skip that says so."""
    found = repository / "../shared/data" / name
    if not (found / file).exists():
        pytest.skip(f"the measured data are not here: {found}")
    return found


@pytest.fixture(scope="module")
def spectra(repository: Path) -> list[FrequencyResponse]:
    return battery.read(folder(repository, "eis_battery_13_states_of_charge", "imiev_15C_eis.csv"))


@pytest.fixture(scope="module")
def half(spectra):
    return [one for one in spectra if one.operating_point == (50.0,)]


def relative(steps, data):
    """Root mean square over the lines of |Y − Ŷ|/|Y| in per cent, as the publications of such data give it."""
    pairs = [[(batch.outputs, step.model.output(batch)) for batch in gather(data)] for step in steps]
    return [100 * np.sqrt(np.mean(np.concatenate([abs(1 - m / y).ravel() for y, m in one]) ** 2)) for one in pairs]


def added(step):
    return [one.effect.kind for one in step.model.effects]


def announced(step):
    return {one.score.candidate.effect.kind for one in step.diagnosis.announced}


def test_the_battery_at_half_charge(half):
    """34.8 % → inductance 21.9 % → a second arc 10.0 % → diffusion 7.9 %, nothing left out of the impedance library."""
    steps = battery.story(half, 0, 0, effects=4)
    assert relative(steps, half) == pytest.approx([34.8, 21.9, 10.0, 7.9], abs=0.1)
    assert [100 * step.error for step in steps] == pytest.approx([41.3, 20.9, 14.6, 12.6], abs=0.1)
    assert all(step.diagnosis.lack_of_fit.p_value < 1e-3 and not step.diagnosis.confident for step in steps)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]
    assert announced(steps[0]) == {"inductance", "lead", "lossy_inductance"}
    assert announced(steps[1]) == {"rc_arc", "cpe_arc", "warburg_short"}
    inductance = steps[3].model.effects[0].coefficients[0, 0]
    assert inductance == pytest.approx(78e-9, rel=0.03)


def test_the_battery_with_the_effects_of_all_domains(half):
    steps = staircase(battery.circuit(half, 0), gather(half), largest=3)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]


def test_the_battery_over_all_states_of_charge(spectra):
    """The same order jointly; the inductance does not depend on the state of charge."""
    steps = battery.story(spectra, 4, 1)
    assert added(steps[3]) == ["inductance", "rc_arc", "warburg"]
    assert relative(steps, spectra) == pytest.approx([36.3, 24.2, 11.7, 9.4], abs=0.1)
    constant, slope = steps[3].model.effects[0].coefficients[0]
    assert constant == pytest.approx(78e-9, rel=0.03)
    assert abs(slope) < 0.02 * constant


@pytest.mark.parametrize(("kind", "errors"), [("A", (93.3, 13.9, 9.05)), ("B", (89.3, 12.9, 5.85))])
def test_the_motor_bench_misses_a_resonance_and_then_a_delay(repository, kind, errors):
    spectra = motor_bench.read(folder(repository, "motor_bench_flexible_coupling", "MultisineTypeB.mat"), kind)
    steps = motor_bench.story(spectra.response())
    assert relative(steps, [spectra.response()]) == pytest.approx(errors, abs=0.1)
    assert added(steps[2]) == ["resonance", "delay"]
    assert steps[1].model.effects[0].effect.frequency / (2 * np.pi) == pytest.approx(76.2, abs=0.3)
    assert steps[2].model.effects[1].coefficients[0, 0] == pytest.approx(0.12e-3, rel=0.06)
    classes = {one["class"]: one for one in motor_bench.line_classes(spectra, steps[2].model)}
    if kind == "A":
        assert classes.keys() == {"excited"}
        return
    assert {name: one["lines"] for name, one in classes.items()} == {
        "excited": 60,
        "unexcited odd": 60,
        "unexcited even": 120,
    }
    assert classes["unexcited odd"]["percent"] == pytest.approx(2.5, abs=0.2)
    assert classes["unexcited even"]["percent"] == pytest.approx(1.5, abs=0.2)
    assert classes["unexcited odd"]["ampere"] > 4 * classes["unexcited odd"]["noise ampere"]
