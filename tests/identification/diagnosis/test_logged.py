"""Quantities of the measurements that are not scheduling variables: logged ones, and the rate of change of p."""

import dataclasses

import numpy as np
import pytest

from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.staircase import relative_error
from identification.effects.rate_dependence import RateDependence
from identification.effects.second_variable import SecondVariable
from identification.errors import MisuseError
from identification.extension.fit import fit
from tests.support.oscillators import MODEL, POINTS, linear, phasors, records

TEMPERATURES = (20.0, 35.0, 22.0, 31.0, 26.0)
HUMIDITIES = (0.5, 0.2, 0.9, 0.4, 0.6)
PER_DEGREE = 0.05
LOGGED = [{"temperature": t, "humidity": h} for t, h in zip(TEMPERATURES, HUMIDITIES, strict=True)]


def softening(change):
    """A factor of the response at p by which the stiffness changes."""
    return lambda p, w: (30 + 10 * p - w**2 + 1.5j * w) / (30 + 10 * p + change - w**2 + 1.5j * w)


def warm_records(seed=0, temperatures=TEMPERATURES):
    generator = np.random.default_rng(seed)
    outputs = []
    for p, t in zip(POINTS, temperatures, strict=True):
        amplitudes = phasors(generator)
        factor = softening(PER_DEGREE * (t - 20.0))
        outputs.append((amplitudes, linear(p, amplitudes, lambda w, p=p, factor=factor: factor(p, w))))
    return records(outputs, generator, 1e-3)


@pytest.fixture(scope="module")
def found():
    return diagnose(MODEL, gather(warm_records(), logged=LOGGED))


def test_the_logged_quantity_that_matters_is_found_with_its_amplitude(found):
    effect = found.best.fit.model.effects[-1]
    assert isinstance(effect.effect, SecondVariable)
    assert effect.effect.quantity == "temperature"
    assert effect.effect.coefficient == 1
    assert effect.effect.reference == pytest.approx(np.mean(TEMPERATURES))
    assert effect.coefficients[0, 0] == pytest.approx(PER_DEGREE, rel=0.02)
    judged = [one.effect.quantity for one in found.visibility if one.effect.kind == "second_variable"]
    assert judged == ["humidity", "temperature"]


def test_the_model_foretells_measurements_at_other_temperatures(found):
    others = (30.0, 21.0, 24.0, 36.0, 20.0)
    model = fit(found.best.fit.model, found.best.fit.rows).model
    batches = gather(warm_records(7, others), logged=[{"temperature": t} for t in others])
    assert relative_error(model, batches) < 0.2 * relative_error(found.base.model, batches)
    with pytest.raises(MisuseError, match="temperature"):
        model.output(gather(warm_records(7, others))[0])


def test_what_was_not_logged_everywhere_is_not_judged():
    partly = [{"temperature": t} if i else {} for i, t in enumerate(TEMPERATURES)]
    (batch,) = gather(warm_records(), logged=partly)
    assert batch.logged == {}
    (seen,) = diagnose(MODEL, (batch,), [SecondVariable()]).visibility
    assert seen.amplitude is None
    assert "logged" in seen.reason


def test_logged_quantities_are_given_for_every_experiment():
    with pytest.raises(MisuseError, match="5 experiments"):
        gather(warm_records(), logged=LOGGED[:3])


def test_logged_quantities_keep_to_their_measurements():
    """Records on two grids: the batches take their own values."""
    plain = warm_records()
    shorter = [dataclasses.replace(one, input=one.input[:384], output=one.output[:384]) for one in plain[:2]]
    batches = gather([plain[0], shorter[0], plain[1], shorter[1]], logged=LOGGED[:4])
    assert [batch.logged["temperature"].tolist() for batch in batches] == [[20.0, 22.0], [35.0, 31.0]]


def test_still_operating_points_cannot_show_a_dependence_on_their_rate():
    batches = gather(warm_records())
    (seen,) = diagnose(MODEL, batches, [RateDependence()]).visibility
    assert seen.amplitude is None
    assert "stand still" in seen.reason
    moving = RateDependence(tuple(t - 20.0 for t in TEMPERATURES))
    best = diagnose(MODEL, batches, [moving]).best
    assert best is not None
    assert best.fit.model.effects[-1].effect.coefficient == 1
    assert best.fit.model.effects[-1].coefficients[0, 0] == pytest.approx(PER_DEGREE, rel=0.02)
