"""The benchmarks of parametric models, made small."""

import numpy as np

from benchmarks import kergus_example, open_channel, parametric_interpolation
from identification.pole_regions.half_plane import HalfPlane
from identification.signals import FrequencyResponse


def test_the_example_without_and_with_noise():
    exact = kergus_example.noise_free()
    assert exact["Algorithm 1"] < 1e-11
    assert max(exact.values()) < 1e-7
    noisy = kergus_example.with_noise(4)
    assert noisy["Algorithm 1"]["unstable"] > 0
    assert noisy["Algorithm 2"]["unstable"] == noisy["Algorithm 2, spectral norm"]["unstable"] == 0
    ratio = noisy["Algorithm 2"]["medianRelativeMisfit"] / noisy["Algorithm 1"]["medianRelativeMisfit"]
    assert ratio < 1.1


def test_between_the_operating_points_the_error_is_below_the_noise():
    errors = parametric_interpolation.compare(0, 0.01)
    assert errors["parametric subspace"] < 0.005
    assert errors["maximum likelihood"] < 0.005
    assert errors["parametric AAA, true degrees"] > 0.005


def test_interpolation_is_exact_without_noise():
    samples = np.array([kergus_example.truth(p) for p in parametric_interpolation.MEASURED]).T
    model = parametric_interpolation.parametric_aaa(samples, (3, 2), 0.0)
    plant = np.array([kergus_example.truth(p) for p in parametric_interpolation.BETWEEN])
    found = model(parametric_interpolation.Z, parametric_interpolation.BETWEEN).T
    assert parametric_interpolation.errors(found, plant) < 1e-8


def test_the_channel_has_models_with_their_poles_on_the_left():
    model, _ = open_channel.fitted(6, HalfPlane(1e-7), (0, 2, 0, 2))
    rows = open_channel.table({"kept": (model, 0.0)})
    assert rows["kept"]["largestRealPart"] < 1e-7
    assert max(rows["kept"]["measured"] + rows["kept"]["between"]) < 1.0
    assert isinstance(open_channel.delay_free_responses(open_channel.OpenChannel())[0], FrequencyResponse)
