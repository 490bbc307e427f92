"""Line classes of a synthetic motor: distortion is found where it was put, referred to the input."""

import numpy as np
import pytest

from benchmarks.motor_bench import HIGHEST, LOWEST, Spectra, line_classes, rigid_body
from identification.extension.response import linear_response

LINES = np.arange(1251)
EXCITED = np.arange(13, 250, 4)


def test_the_distortion_of_each_class_is_that_put_in():
    generator = np.random.default_rng(0)
    current = np.where(np.isin(LINES, EXCITED), 0.8 * np.exp(2j * np.pi * generator.random(1251)), 0.0)
    response = 1 / -((2 * np.pi * np.maximum(LINES, 1.0)) ** 2)
    model = rigid_body(Spectra(current[None], (response * current)[None], EXCITED).response())
    linear = linear_response(model, [[0.0]], 2 * np.pi * LINES[LOWEST:].astype(float)).response[0]
    beyond = np.select([np.isin(LINES, EXCITED), LINES % 2 == 1], [0.0, 0.02], 0.005)[LOWEST:]
    noise = 1e-4 * (generator.standard_normal((18, 1251)) + 1j * generator.standard_normal((18, 1251)))[:, LOWEST:]
    leaked = np.where(np.isin(LINES, EXCITED), current, 0.01)[LOWEST:]
    angle, measured = np.zeros((18, 1251), complex), np.zeros((18, 1251), complex)
    angle[:, LOWEST:] = linear * (leaked + beyond + noise)
    measured[:, LOWEST:] = leaked
    classes = {one["class"]: one for one in line_classes(Spectra(measured, angle, EXCITED), model)}
    band = np.arange(LOWEST, HIGHEST + 1)
    assert classes["unexcited odd"]["lines"] == np.sum((band % 2 == 1) & ~np.isin(band, EXCITED))
    assert classes["unexcited odd"]["percent"] == pytest.approx(100 * 0.02 / 0.8, rel=0.01)
    assert classes["unexcited even"]["percent"] == pytest.approx(100 * 0.005 / 0.8, rel=0.01)
    assert classes["unexcited odd"]["noise ampere"] == pytest.approx(1e-4 * np.sqrt(2 / 18), rel=0.1)
