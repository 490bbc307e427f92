"""An axis that integrates is stated with a pole at zero, exactly, where its response has no value."""

from dataclasses import replace

import numpy as np
import pytest

from identification.bases.polynomial import Polynomial
from identification.channels import Channel, Channels
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.models.model import Model
from identification.models.rational import RationalStructure
from identification.scheduling import ParameterDependence, ProductBasis, SchedulingVariable
from identification.signals import TimeRecord

PERIOD, PERIODS, SETTLING, STEP, GAIN = 128, 8, 4, 0.1, 2.0
SPEED = Channels(Channel("u", "voltage", "V"), Channel("y", "position", "m"))


def record(p, generator):
    """y′ = g(p) u, u held between samples, u = r − y as measured, over whole periods of r."""
    lines = np.arange(1, 30)
    phases = np.exp(2j * np.pi * generator.random(len(lines)))
    reference = np.real(np.exp(2j * np.pi * np.outer(np.arange(PERIOD), lines) / PERIOD) @ phases)
    samples, y = (SETTLING + PERIODS) * PERIOD, 0.0
    u, seen = np.empty(samples), np.empty(samples)
    for n in range(samples):
        seen[n] = y + 0.02 * generator.standard_normal()
        u[n] = reference[n % PERIOD] - seen[n]
        y += STEP * GAIN * (1 + p) * u[n]
    keep = slice(SETTLING * PERIOD, None)
    return TimeRecord(u[keep], seen[keep], STEP, (p,), PERIOD, SPEED, "zero", True)


@pytest.fixture(scope="module")
def batches():
    generator = np.random.default_rng(4)
    return gather([record(p, generator) for p in (0.0, 0.5, 1.0)])


@pytest.fixture(scope="module")
def axis():
    load = SchedulingVariable("load", "", 0.0, 1.0)
    bases = (ProductBasis((Polynomial(0),)), ProductBasis((Polynomial(1),)))
    theta = np.array([0.0, GAIN, GAIN])
    return Model(RationalStructure(1, 0), ParameterDependence((load,), bases), theta, np.eye(3), 1.0)


def test_nothing_is_missing_of_an_axis_stated_with_its_pole_at_zero(axis, batches):
    found = diagnose(axis, batches)
    assert found.verdict == "nothing missing"
    assert np.isfinite(found.base.model.theta).all()
    assert found.base.model.theta[1:] == pytest.approx([GAIN, GAIN], rel=0.05)


def test_it_is_compared_as_it_stands(axis, batches):
    seen = compare(axis, batches)
    assert np.isfinite(seen.fit_percent).all()
    assert seen.overall.p_value > 1e-4
    assert compare(replace(axis, theta=np.array([0.0, 3.0, 1.0])), batches).overall.p_value < 1e-6
