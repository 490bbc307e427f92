"""What experiments tell about effects, held against differences of what the model answers."""

from dataclasses import replace

import numpy as np
import pytest

from identification.arrays import ComplexArray, FloatArray
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.delay import Delay
from identification.effects.drift_of_gain import DriftOfGain
from identification.effects.lag import Lag
from identification.effects.resonance import Resonance
from identification.errors import MisuseError
from identification.models.model import Model
from identification.places.placed import placed
from oed.hypothesis import Hypothesis, response_batch
from oed.spectra.multisines import Multisines, record_batch
from oed.subject import Subject
from tests.support.oscillators import MODEL, SAMPLE_TIME

NOISE = 0.04
PLANT = replace(MODEL, noise_variance=NOISE)
WITH_EFFECTS = PLANT.plus(placed(Delay(), 0, 1, 0.03)).plus(placed(Resonance(9.0, 0.1), 0, 1, 0.2))
POINTS = np.array([[-0.5], [0.8]])
OMEGA = np.array([0.7, 3.0, 5.5, 9.5, 14.0])


def by_differences(model: Model, points: FloatArray, omega: FloatArray) -> ComplexArray:
    """∂G by every parameter of the model, (M, F, k), from central differences of what it answers to U = 1."""
    batch = response_batch(model, points, omega)
    columns = []
    for i, value in enumerate(model.parameters):
        step = 1e-6 * max(abs(value), 1e-2)
        ends = [model.with_parameters(_moved(model.parameters, i, sign * step)).output(batch) for sign in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2 * step))
    return np.stack(columns, axis=-1)


def _moved(values: FloatArray, i: int, step: float) -> FloatArray:
    values = values.copy()
    values[i] += step
    return values


def information(a: ComplexArray) -> FloatArray:
    return np.einsum("mfi,mfj->mfij", a, a.conj()).real


def test_linear_effects_as_by_differences() -> None:
    given = Hypothesis(WITH_EFFECTS).sensitivity(POINTS, OMEGA)
    assert given.shape == (2, 5, 4 + 1 + 3)
    expected = information(by_differences(WITH_EFFECTS, POINTS, OMEGA)) / NOISE
    assert information(given) == pytest.approx(expected, rel=1e-5, abs=1e-9 * abs(expected).max())


def test_a_suspected_effect_counts_at_amplitude_zero() -> None:
    given = Hypothesis(PLANT, suspected=placed(Lag(), 0, 1)).sensitivity(POINTS, OMEGA)
    there = by_differences(PLANT.plus(placed(Lag(), 0, 1, 1e-9)), POINTS, OMEGA)
    expected = information(there) / NOISE
    assert information(given) == pytest.approx(expected, rel=1e-4, abs=1e-7 * abs(expected).max())


def test_a_rival_counts_by_how_far_away_it_is() -> None:
    rival = PLANT.plus(placed(Delay(), 0, 1, 0.2))
    given = Hypothesis(PLANT, rival=rival).sensitivity(POINTS, OMEGA)[..., -1]
    batch = response_batch(PLANT, POINTS, OMEGA)
    assert abs(given) == pytest.approx(abs(rival.output(batch) - PLANT.output(batch)) / np.sqrt(NOISE), rel=1e-9)


def test_a_spectrum_and_its_signal_tell_the_same_about_linear_effects() -> None:
    subject = Subject((Hypothesis(WITH_EFFECTS), Hypothesis(PLANT, suspected=placed(Lag(), 0, 1))))
    signal = Multisines(128, (3.0,), seed=2).signals(None, SAMPLE_TIME)[0]
    by_signal = subject.by_record(record_batch(PLANT, POINTS, signal, SAMPLE_TIME))
    a = subject.sensitivity(POINTS, signal.frequencies)
    by_spectrum = subject.mask * np.einsum("f,mfi,mfj->mij", signal.period_energies, a, a.conj()).real
    assert by_signal == pytest.approx(by_spectrum, rel=1e-9, abs=1e-12 * by_spectrum.max())
    assert not by_signal[:, :8, 8:].any()


@pytest.mark.parametrize("level", [2.0, 6.0])
def test_effects_on_signals_as_by_differences(level: float) -> None:
    signal = Multisines(128, (level,), ((0.5, 12.0),), seed=2).signals(None, SAMPLE_TIME)[0]
    batch = record_batch(PLANT, POINTS, signal, SAMPLE_TIME)
    one = Hypothesis(PLANT, suspected=placed(CubicStiffness(), 0, 1))
    given = one.by_record(batch)
    e = 1e-4
    change = (PLANT.plus(placed(CubicStiffness(), 0, 1, e)).output(batch) - PLANT.output(batch)) / e
    rows = batch.whiten(change).reshape(2, -1)
    assert given[:, -1, -1] == pytest.approx(np.sum(rows**2, axis=1), rel=1e-3)
    theta = Hypothesis(PLANT).tangents([batch]).reshape(4, 2, -1)
    assert given[:, -1, :-1] == pytest.approx(np.einsum("mr,kmr->mk", rows, theta), rel=1e-2, abs=1e-6 * given.max())


def test_what_an_experiment_shows_of_a_cubic_effect_grows_with_the_sixth_power_of_the_level() -> None:
    hypothesis = Hypothesis(PLANT, suspected=placed(CubicStiffness(), 0, 1))
    signals = Multisines(128, (1.0, 2.0), ((0.5, 12.0),), seed=2).signals(None, SAMPLE_TIME)
    shown = [hypothesis.by_record(record_batch(PLANT, POINTS, one, SAMPLE_TIME)) for one in signals]
    assert shown[1][:, -1, -1] == pytest.approx(64 * shown[0][:, -1, -1], rel=1e-9)


def test_effects_that_a_spectrum_says_nothing_about() -> None:
    with pytest.raises(MisuseError, match="candidate multisines"):
        Hypothesis(PLANT, suspected=placed(CoulombFriction(), 0, 1)).sensitivity(POINTS, OMEGA)
    with pytest.raises(MisuseError, match="how or when was measured"):
        Hypothesis(PLANT, suspected=placed(DriftOfGain(), 0, 1)).sensitivity(POINTS, OMEGA)
