"""Noise on both signals and controllers that act on noise, against loops integrated in small steps."""

import numpy as np
import pytest

from identification.comparison.both_signals import _noise
from identification.comparison.gather import gather
from identification.comparison.noise import noise_of_mean
from identification.diagnosis.diagnose import diagnose, rows_of
from identification.effects.coulomb_friction import CoulombFriction
from identification.effects.cubic_stiffness import CubicStiffness
from identification.effects.dead_zone import DeadZone
from identification.effects.delay import Delay
from identification.extension.fit import fit
from identification.signals import TimeRecord
from tests.support.motions import POINTS, STEP, continuous, integrated, model, nothing

PERIOD, PERIODS = 128, 4
SOME = (CoulombFriction(), CubicStiffness(), DeadZone(), Delay())


def in_a_loop(seed, noise, gain, rate=0.0, force=nothing, level=1.0, stiffness=36.0, lines=50):
    """Periodic records of u = r − gain y − rate ẏ with noise on the y that the controller sees."""
    g = np.random.default_rng(seed)
    spectrum = np.zeros((len(POINTS), PERIOD // 2 + 1), dtype=complex)
    spectrum[:, 1:lines] = np.exp(2j * np.pi * g.random((len(POINTS), lines - 1)))
    r = np.fft.irfft(spectrum, n=PERIOD)
    r *= level / np.std(r)
    shown, before = [], [np.zeros(len(POINTS))]

    def control(t, x):
        y = x + noise * g.standard_normal(len(POINTS))
        u = r[:, t % PERIOD] - gain * y - rate * (y - before[0]) / STEP
        before[0] = y
        shown.append(y)
        return u

    samples = PERIOD * (PERIODS + 3)
    inputs, _ = integrated(control, samples, force, stiffness)
    y, kept = np.array(shown).T, slice(3 * PERIOD, None)
    return [
        TimeRecord(u[kept], one[kept], STEP, (float(p),), PERIOD, hold="zero", feedback=True)
        for p, u, one in zip(POINTS, inputs, y, strict=True)
    ]


def deviations(start, batches, truth):
    """(θ̂ − θ)/deviation and the joint distance squared."""
    base = fit(start, rows_of(start, batches), tolerance=1e-9)
    off, covariance = base.model.theta - truth, base.model.joint_covariance
    return off / np.sqrt(np.diag(covariance)), off @ np.linalg.solve(covariance, off)


def test_feedback_of_noise_leaves_no_bias():
    """The estimate is about the truth, and as far from it as its covariance says."""
    truth = np.array([0.4, 1.0, 1.0, 0.5])
    found = [deviations(continuous(), gather(in_a_loop(seed, 0.3, 0.8)), truth) for seed in range(12)]
    z = np.array([one for one, _ in found])
    assert np.all(abs(z.mean(axis=0)) < 3 * z.std(axis=0) / np.sqrt(len(z)) + 0.3)
    assert np.mean([distance for _, distance in found]) == pytest.approx(4.0, abs=3.0)


def test_noise_on_the_measured_input_leaves_no_bias():
    """With the input taken as known the gain is two deviations too small on average."""
    z = []
    truth = np.array([0.4, 1.0, 1.0, 0.5])
    for seed in range(12):
        g = np.random.default_rng(seed)
        clean = in_a_loop(seed, 0.0, 0.0)
        noisy = [
            TimeRecord(
                one.input + 0.4 * g.standard_normal(len(one)),
                one.output + 0.02 * g.standard_normal(len(one)),
                STEP,
                one.operating_point,
                PERIOD,
                hold="zero",
            )
            for one in clean
        ]
        z.append(deviations(continuous(), gather(noisy), truth)[0])
    assert np.all(abs(np.mean(z, axis=0)) < 0.8)


@pytest.mark.parametrize("start", [model, continuous])
def test_friction_in_a_loop_is_found_and_measured(start):
    force = lambda x, v: 0.06 * np.tanh(v / 1e-3)  # noqa: E731
    found = diagnose(start(), gather(in_a_loop(2, 0.003, 0.5, force=force)), SOME)
    assert found.announced[0].score.candidate.effect.kind == "coulomb_friction"
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(0.06, rel=0.05)


def test_a_hardening_spring_on_an_unstable_plant_is_found_and_measured():
    """ẍ = 36 (u − 0.3 x³) + 20 x − 2.4 ẋ stands by its controller alone, and is simulated nowhere."""
    force = lambda x, v: 0.3 * x**3  # noqa: E731
    batches = gather(in_a_loop(3, 1e-4, 2.5, 0.2, force, stiffness=-20.0))
    found = diagnose(continuous(-20.0), batches, SOME)
    assert found.announced[0].score.candidate.effect.kind == "cubic_stiffness"
    assert found.best.fit.model.effects[0].coefficients[0, 0] == pytest.approx(0.3, rel=0.05)


def test_lines_without_excitation_do_not_pass_as_excited():
    (batch,) = gather(in_a_loop(4, 0.1, 0.8, lines=20))
    assert np.all(batch.classes[:, 20:] != 0)
    assert np.all(batch.classes[:, 1:20] == 0)


def test_noise_on_the_input_of_a_resonant_plant_is_sized_line_by_line():
    """Var(Y − G U) = σ_y² + |G|² σ_u² has the peak of the plant, which no window of lines and no low order follows."""
    omega = 2 * np.pi * np.arange(129) / (256 * 0.05)
    response = 1 / (90 - omega**2 + 1.2j * omega)
    ratios = []
    for seed in range(12):
        g = np.random.default_rng(seed)
        noise_u, noise_y = (s * g.standard_normal((4, 256)) for s in (0.3, 0.002))
        u, y = (np.fft.rfft(x) / 256 for x in (noise_u, noise_y))
        found = _noise(y - response * u, response, (omega == 0) | (np.arange(129) == 128), noise_of_mean)
        ratios.append(found.variance[1:-1] * 4 * 256 / (0.002**2 + abs(response[1:-1]) ** 2 * 0.3**2))
    mean = np.mean(ratios, axis=0)
    assert np.all(abs(mean - 1) < 0.25)
    assert np.mean(mean) == pytest.approx(1, abs=0.05)


def test_noise_that_has_nothing_to_do_with_the_input_is_pooled_as_it_was():
    g = np.random.default_rng(3)
    response = 1 / (90 - np.linspace(0, 30, 129) ** 2 + 5j)
    errors = np.fft.rfft(g.standard_normal((6, 256))) / 256
    real = np.arange(129) % 128 == 0
    np.testing.assert_allclose(
        _noise(errors, response, real, noise_of_mean).variance, noise_of_mean(errors, real).variance
    )
