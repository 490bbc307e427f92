"""Where a model fails: by operating point, band, line class, and whether p or the dynamics are to blame."""

from dataclasses import replace

import numpy as np
import pytest

from identification.comparison.batch import EXCITED
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.errors import MisuseError, RangeError
from identification.signals import FrequencyResponse, TimeRecord
from tests.support.oscillators import (
    MODEL,
    PERIOD,
    POINTS,
    SAMPLE_TIME,
    batches,
    clean_records,
    linear,
    phasors,
    records,
)


def bent(seed, sigma=3e-3):
    """Stiffness with a quadratic part in p, which the model has not."""
    g = np.random.default_rng(seed)
    inputs = [phasors(g) for _ in POINTS]
    return gather(
        records([(a, linear(p + 0.06 * (p * p - 0.5), a)) for p, a in zip(POINTS, inputs, strict=True)], g, sigma)
    )


def test_nothing_fails_when_nothing_is_missing():
    ps = [
        [t.p_value for t in (c.overall, c.dependence, c.dynamics)]
        for c in (compare(MODEL, batches(s)) for s in range(60))
    ]
    assert np.all(np.mean(np.array(ps) < 0.1, axis=0) < 0.25)
    assert 0.35 < np.mean(ps) < 0.65
    found = compare(MODEL, batches(1))
    assert len(found.by_point) == 5
    assert found.fit_percent.min() > 98


def test_a_comparison_shows_the_model_as_it_is_and_what_a_refit_would_bring_beside_it():
    """Half the gain: 50 % fit on the very data that it is said to be fitted to, and all is well after a refit."""
    halved = replace(MODEL, theta=MODEL.theta * np.array([1, 1, 1, 0.5]))
    found = compare(halved, batches(1))
    assert found.fit_percent == pytest.approx(compare(halved, batches(1), fitted=False).fit_percent)
    assert found.fit_percent == pytest.approx(50, abs=2)
    assert found.refit_percent.min() > 98
    assert found.overall.p_value < 1e-9 < 1e-3 < found.refitted.p_value
    assert found.dependence.p_value > 1e-3
    seen = found.maps[0].responses
    assert abs(seen.modelled[seen.shown]) == pytest.approx(0.5 * abs(seen.measured[seen.shown]), rel=0.2)


def test_degrees_of_freedom_count_what_was_fitted_once():
    """Four parameters of θ; three coefficients at each of five operating points."""
    data = batches(1)
    found = compare(MODEL, data)
    rows = sum(batch.row_count for batch in data)
    assert found.overall.degrees_of_freedom == pytest.approx(rows - 4)
    for parts in (found.by_point, found.by_band, found.by_class):
        assert sum(part.degrees_of_freedom for part in parts) == pytest.approx(rows - 4)
    assert found.dependence.degrees_of_freedom == 3 * 5 - 4
    assert found.dynamics.degrees_of_freedom == rows - 3 * 5
    assert compare(MODEL, data, fitted=False).overall.degrees_of_freedom == rows


def test_the_map_has_unit_variance():
    values = [abs(m.residual[m.compared]) ** 2 for s in range(10) for m in compare(MODEL, batches(s)).maps]
    assert np.mean(np.concatenate(values)) == pytest.approx(1.0, abs=0.05)


def test_the_responses_are_those_of_plant_and_model():
    spreads = []
    many = [batches(seed) for seed in range(10)]
    for batch, one in [pair for data in many for pair in zip(data, compare(MODEL, data).maps, strict=True)]:
        response, seen = MODEL.frequency_response(batch.points, batch.omega)[..., 0, 0], one.responses
        shown = seen.shown
        assert shown.any(axis=1).all()
        assert np.all(one.classes[shown] == EXCITED)
        np.testing.assert_allclose(seen.modelled[shown], response[shown], rtol=0.05)
        spreads.append(abs(seen.measured - seen.modelled)[shown] / seen.deviation[shown])
    assert np.mean(np.concatenate(spreads) ** 2) == pytest.approx(1.0, abs=0.1)


def test_a_wrong_dependence_is_not_taken_for_wrong_dynamics():
    found = compare(MODEL, bent(1))
    assert found.overall.p_value < 1e-9
    assert found.dependence.p_value < 1e-9
    assert found.dynamics.p_value > 1e-3


def test_wrong_dynamics_are_not_taken_for_a_wrong_dependence():
    found = compare(MODEL, batches(2, extra=lambda w: 1 / (1 + 0.02j * w)))
    assert found.dynamics.p_value < 1e-9
    assert found.dependence.p_value > 1e-3


def test_even_distortion_shows_in_the_even_lines_only():
    spoilt = [
        TimeRecord(r.input, r.output + 0.05 * r.output**2, SAMPLE_TIME, r.operating_point, PERIOD)
        for r in clean_records(3)
    ]
    found = {test.name: test.p_value for test in compare(MODEL, gather(spoilt)).by_class}
    assert found["unexcited even"] < 1e-9
    assert found["unexcited odd"] > 1e-4


def test_a_misfit_of_one_band_is_found_there():
    found = compare(MODEL, batches(4, extra=lambda w: 1 + 0.08 * (w > 9)))
    worst = min(found.by_band, key=lambda test: test.p_value)
    assert float(worst.name.split("…")[1].split()[0]) > 9


def test_held_out_data_count_the_uncertainty_of_the_model():
    """A model off by two of its own standard deviations is refused only when it pretends to know better."""
    covariance = np.diag([0.02, 0.1, 0.1, 0.01]) ** 2
    draw = np.random.default_rng(5).multivariate_normal(MODEL.theta, covariance)
    unsure = replace(MODEL, theta=draw, covariance=covariance)
    sure = replace(MODEL, theta=draw, covariance=1e-12 * np.eye(4))
    assert compare(unsure, batches(6), fitted=False).overall.p_value > 1e-3
    assert compare(sure, batches(6), fitted=False).overall.p_value < 1e-6


def test_without_known_noise_there_are_no_tests_but_a_map():
    omega = np.linspace(1, 9, 30)
    responses = [
        FrequencyResponse(omega, MODEL.frequency_response([[p]], omega)[0, :, 0, 0] * (1 + 0.01j), (p,)) for p in POINTS
    ]
    found = compare(MODEL, gather(responses))
    assert found.overall is None
    assert found.by_point == ()
    assert len(found.maps) == 1


def test_misuse_is_named():
    with pytest.raises(RangeError, match="outside its range"):
        compare(MODEL, gather([TimeRecord(r.input, r.output, SAMPLE_TIME, (9.0,), PERIOD) for r in clean_records()]))
    nothing = replace(MODEL, covariance=np.full((4, 4), np.inf))
    with pytest.raises(MisuseError, match="no covariance"):
        compare(nothing, batches(), fitted=False)
    discrete = replace(MODEL, structure=replace(MODEL.structure, sample_time=0.2))
    with pytest.raises(MisuseError, match="sample time"):
        compare(discrete, batches())
