"""Plots show what they are given, for models beyond the demonstration: complex poles, line spectra, no truth."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from app.report.axes import Axes
from app.report.document import Plot
from app.report.figures.bode import bode, gain_accuracy
from app.report.figures.energies import energy_comparison, energy_per_point
from app.report.figures.poles import poles
from app.report.figures.spectra import spectra
from identification.signals import FrequencyResponse
from oed.design import DesignedExperiment
from oed.spectra.lines import LineSpectrum
from tests.app.report.models import POINTS, SPEED, resonance

AXES = Axes((SPEED,), "force", "N", "position", "mm")
OMEGA = np.geomspace(0.05, 6.0, 40)
EXPERIMENTS = [
    DesignedExperiment(
        (p,), 30.0, LineSpectrum(np.pi * np.array([1, 4]) / 16, np.array([10.0, 20.0]), np.array([1, 4]), 64)
    )
    for p in (0.0, 2.0)
]


def curves(plot: Plot, name: str) -> list[np.ndarray]:
    return [np.asarray(trace.y) for trace in plot.figure.data if trace.name == name and trace.mode == "lines"]


def test_bode_shows_gain_and_phase_of_model_and_truth() -> None:
    model = resonance()
    plot = bode(model, [(1.0,)], OMEGA, AXES, truth=model)
    response = model.frequency_response([(1.0,)], OMEGA)[0, :, 0, 0]
    for name in ("n = 1 1/s", "truth"):
        gain, phase = curves(plot, name)[-2:]
        np.testing.assert_allclose(gain, abs(response))
        np.testing.assert_allclose(np.exp(1j * np.deg2rad(phase)), response / abs(response))


def test_bode_leaves_out_points_that_are_noise_and_keeps_the_phase_near_the_model() -> None:
    model = resonance()
    response = model.frequency_response([(1.0,)], OMEGA)[0, :, 0, 0]
    variance = np.where(np.arange(len(OMEGA)) < 30, 1e-4, 1.0) * abs(response) ** 2
    measured = FrequencyResponse(OMEGA, response, (1.0,), 0.5, variance)
    plot = bode(model, [(1.0,)], OMEGA, AXES, [measured])
    gain, phase = (trace for trace in plot.figure.data if trace.mode == "markers")
    np.testing.assert_allclose(gain.y, abs(response[:30]))
    np.testing.assert_allclose(phase.y, np.rad2deg(np.unwrap(np.angle(response)))[:30])


def test_the_error_of_the_gain_of_the_truth_is_zero_and_its_sign_is_right() -> None:
    truth = resonance()
    louder = replace(truth, theta=truth.theta * [1, 1, 1, 1, 1.01, 1.01])
    plot = gain_accuracy([("same", truth), ("louder", louder)], [(1.0,)], OMEGA, AXES, truth)
    np.testing.assert_allclose(curves(plot, "same")[-1], 0.0, atol=1e-12)
    np.testing.assert_allclose(curves(plot, "louder")[-1], 1.0, rtol=1e-9)


def test_complex_poles_have_two_parts() -> None:
    model = resonance()
    plot = poles(model, POINTS, AXES, truth=model)
    lower = np.sort_complex(model.poles(POINTS))[:, 0]
    real, imaginary = curves(plot, "model, pole 1")
    np.testing.assert_allclose(real, lower.real)
    np.testing.assert_allclose(imaginary, lower.imag)
    assert len(plot.table.rows[0]) == 4


@pytest.mark.parametrize(
    "make",
    [
        lambda: poles(resonance(None), POINTS, AXES),
        lambda: gain_accuracy([("one", resonance())], [(0.0,), (2.0,)], OMEGA, AXES),
        lambda: bode(resonance(None), [(0.0,)], OMEGA, AXES),
        lambda: spectra(EXPERIMENTS, 64, 0.5, AXES),
        lambda: energy_per_point(EXPERIMENTS, POINTS, AXES),
    ],
)
def test_every_plot_has_finite_numbers_and_a_table(make: Callable[[], Plot]) -> None:
    plot = make()
    assert plot.caption.endswith(".")
    assert plot.table.rows
    assert {len(row) for row in plot.table.rows} == {len(plot.table.columns)}
    for trace in plot.figure.data:
        assert np.all(np.isfinite(np.asarray(trace.y, dtype=float)))


def test_line_spectra_are_drawn_at_their_frequencies() -> None:
    plot = spectra(EXPERIMENTS, 64, 0.5, AXES)
    np.testing.assert_allclose(plot.figure.data[0].x, np.array([1, 4]) / 32)
    np.testing.assert_allclose(plot.figure.data[0].y, [10.0, 20.0])
    assert plot.table.rows[0][1:] == ("10.0", "10.0")


def test_energies_are_compared_with_the_first() -> None:
    plot = energy_comparison((("designed", 200.0), ("white", 500.0)), AXES)
    assert [row[1:] for row in plot.table.rows] == [("200.0", "100 %"), ("500.0", "250 %")]
    assert energy_per_point(EXPERIMENTS, POINTS, AXES).table.rows[-1] == ("all", "60.00", "100 %")
