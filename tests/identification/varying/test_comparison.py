"""Comparisons with records along p(t): distributions where nothing is missing, and power where something is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.wind_turbine_plant import PLANT
from identification.errors import MisuseError
from identification.varying.comparison import VaryingComparison, compare_varying
from identification.varying.output_error import OutputError
from identification.varying.periodic_likelihood import PeriodicLikelihood
from identification.varying.records import VaryingRecord
from tests.support import varying

NOISE = 0.02**2 * np.eye(2)


def periodic(seed: int) -> VaryingRecord:
    return VaryingRecord(*varying.turbine(seed), 1.0, varying.PERIOD, PLANT.variables)


def free(seed: int) -> VaryingRecord:
    model = varying.cox_plant()
    return VaryingRecord(*varying.white(model, 500, seed), 1.0, None, model.variables)


@cache
def pairs() -> list[tuple[VaryingComparison, VaryingComparison]]:
    """Fitted and held out, synchronised."""
    found = []
    for seed in range(0, 80, 2):
        estimate = PeriodicLikelihood().estimate(periodic(seed), 2)
        found.append(
            (
                compare_varying(estimate.model, periodic(seed), True),
                compare_varying(estimate.model, periodic(seed + 1), False),
            )
        )
    return found


@pytest.mark.parametrize("which", [0, 1])
def test_the_lack_of_fit_has_its_distribution(which: int) -> None:
    one = [pair[which] for pair in pairs()]
    p = np.array([found.lack_of_fit.p_value for found in one if found.lack_of_fit is not None])
    bands = np.array([[test.p_value for test in found.by_band] for found in one])
    assert len(p) == len(one)
    assert p.mean() == pytest.approx(0.5, abs=4 * 0.29 / np.sqrt(len(p)))
    assert bands.mean() == pytest.approx(0.5, abs=4 * 0.29 / np.sqrt(bands.size))
    assert np.mean([np.mean(abs(found.residual) ** 2) for found in one]) == pytest.approx(1, abs=0.12)
    assert np.mean([found.errors.std() for found in one]) == pytest.approx(1, abs=0.03)


def test_free_records_are_tested_over_time() -> None:
    tests: dict[tuple[str, bool], list[float]] = {}
    for seed in range(0, 50, 2):
        estimate = OutputError().estimate(free(seed), None, varying.cox_plant().model())
        for record, fitted in ((free(seed), True), (free(seed + 1), False)):
            found = compare_varying(estimate.model, record, fitted, NOISE)
            assert found.lack_of_fit is None
            for test in found.tests:
                tests.setdefault((test.name, fitted), []).append(test.p_value)
    for name, values in tests.items():
        assert np.mean(values) == pytest.approx(0.5, abs=4 * 0.29 / np.sqrt(len(values))), name
    assert {name.split(":")[0] for name, _ in tests} >= {
        "A1",
        "independence of the errors from past input and scheduling",
    }


def test_what_is_missing_is_seen_in_both() -> None:
    estimate = PeriodicLikelihood().estimate(periodic(0), 2)
    louder = replace(periodic(1), output=1.05 * periodic(1).output)
    found = compare_varying(estimate.model, louder, False)
    assert found.lack_of_fit is not None
    assert found.lack_of_fit.p_value < 1e-9
    other = OutputError().estimate(free(0), None, varying.cox_plant().model())
    record = replace(free(1), output=1.02 * free(1).output)
    assert compare_varying(other.model, record, False, NOISE).tests[-1].p_value < 1e-9


def test_held_out_data_need_a_covariance() -> None:
    bare = PLANT.model()
    with pytest.raises(MisuseError, match="no covariance"):
        compare_varying(bare, periodic(1), False)
    assert compare_varying(bare, periodic(1), True).variance_accounted_for > 98
