"""Several inputs and outputs: rows of paths, correlated noise, tests by path, effects in the right place."""

import numpy as np
import pytest

from benchmarks.hidden_channel import HELD_OUT, OMEGA, POINTS, responses
from identification.comparison.compare import compare
from identification.comparison.gather import gather
from identification.diagnosis.diagnose import diagnose
from identification.diagnosis.staircase import refined, relative_error
from identification.effects.delay import Delay
from identification.effects.lag import Lag
from identification.errors import MisuseError
from identification.extension.response import linear_response
from identification.models.state_space import StateSpaceStructure
from identification.places.placed import placed
from identification.places.ports import Port, ports
from identification.signals import FrequencyResponse
from tests.support.varying import cox_plant

PLANT = cox_plant()
NOTHING = np.ones((len(OMEGA), 2, 2), dtype=np.complex128)


def model():
    return PLANT.model(np.eye(48))


def test_a_path_answers_as_in_the_whole_response() -> None:
    generator = np.random.default_rng(1)
    structure = StateSpaceStructure(3, 2, 3, 0.5)
    zeta, omega = 0.3 * generator.standard_normal((4, structure.size)), np.array([0.2, 1.0, 3.0])
    channels = np.array([[0, 0], [2, 1], [1, 0], [2, 0]])
    whole, gradient = structure.response(zeta, omega), structure.gradient(zeta, omega)
    found, by_zeta = (f(zeta, omega, channels) for f in (structure.channel_response, structure.channel_gradient))
    for m, (i, k) in enumerate(channels):
        assert np.allclose(found[m], whole[m, :, i, k])
        assert np.allclose(by_zeta[m].T, gradient[m, :, i, k])


def test_correlated_noise_becomes_white() -> None:
    """Over 40 draws of 7 points × 40 lines × 4 paths; the covariance between paths is what a plain count gives."""
    generator, total = np.random.default_rng(2), np.zeros((4, 4), dtype=np.complex128)
    exact = model()
    for _ in range(40):
        (batch,) = gather(responses(PLANT, POINTS, NOTHING, generator))
        z = batch.complex_residual(batch.measured - batch.whiten(exact.output(batch)))
        z = z.reshape(len(POINTS), 4, -1)
        total += np.einsum("mik,mjk->ij", z, z.conj()) / z.shape[0] / z.shape[2] / 40
    assert np.allclose(total, np.eye(4), atol=0.05)
    assert batch.shape == (2, 2)
    assert batch.ports[:4].tolist() == [[0, 0], [0, 1], [1, 0], [1, 1]]


def test_lack_of_fit_overall_and_by_path() -> None:
    generator = np.random.default_rng(3)
    p, paths = [], []
    for _ in range(12):
        found = compare(model(), gather(responses(PLANT, POINTS, NOTHING, generator)))
        assert found.refitted is not None
        p.append(found.refitted.p_value)
        paths.append([test.p_value for test in found.by_path])
        assert [test.name for test in found.by_path][1] == "from input 2 to output 1"
        assert found.fit_percent.shape == (len(POINTS),)
    assert 0.2 < np.mean(p) < 0.8
    assert np.mean(paths) > 0.2
    changed = NOTHING.copy()
    changed[:, 1, 0] = np.exp(-0.02j * OMEGA)
    worse = compare(model(), gather(responses(PLANT, POINTS, changed, generator)))
    assert [test.p_value < 1e-6 for test in worse.by_path] == [False, False, True, False] or (
        worse.by_path[2].p_value == min(test.p_value for test in worse.by_path)
    )


@pytest.mark.parametrize("port", [Port(1, 0), Port(0, None), Port(None, 1)], ids=str)
@pytest.mark.parametrize("effect", [Delay(), Lag()], ids=lambda effect: effect.kind)
def test_a_hidden_effect_is_placed_where_it_is(effect: Delay | Lag, port: Port) -> None:
    generator, factor = np.random.default_rng(4), NOTHING.copy()
    shape = np.exp(-0.3j * OMEGA) if effect.kind == "delay" else 1 / (1 + 0.3j * OMEGA)
    there = port.acts(np.array([[0, 0], [0, 1], [1, 0], [1, 1]]), 4).reshape(2, 2)
    factor[:, there] = shape[:, None]
    batches, held_out = (gather(responses(PLANT, p, factor, generator)) for p in (POINTS, HELD_OUT))
    found = diagnose(model(), batches, effects=(Delay(), Lag()))
    assert found.best is not None
    last = found.best.fit.model.effects[-1]
    assert (last.effect.kind, last.port) == (effect.kind, port)
    assert found.confident
    assert last.coefficients[0, 0] == pytest.approx(0.3, abs=0.02)
    grown = refined(found.best.fit).model
    noise = relative_error(model(), gather(responses(PLANT, HELD_OUT, NOTHING, generator)))
    assert relative_error(found.base.model, held_out) > 3 * noise
    assert relative_error(grown, held_out) < 1.3 * noise
    one = linear_response(grown, [[0.3, 0.2]], OMEGA, channel=(1, 0)).response[0]
    exact = (PLANT.frequency_response(np.array([[0.3, 0.2]]), OMEGA)[0] * factor)[:, 1, 0]
    assert abs(one - exact).max() < 0.02


def test_where_nothing_is_hidden_nothing_is_found() -> None:
    found = diagnose(model(), gather(responses(PLANT, POINTS, NOTHING, np.random.default_rng(5))))
    assert not found.announced
    assert found.remaining.p_value > 1e-3


def test_places() -> None:
    assert len(ports(2, 2)) == 1 + 2 + 2 + 4
    assert ports(1, 1) == (Port(),)
    assert ports(3, 1) == (Port(), Port(0), Port(1), Port(2))
    assert str(Port(0, 1)) == "from input 2 to output 1"


def test_other_channels_are_refused() -> None:
    data = responses(PLANT, POINTS[:1], NOTHING, np.random.default_rng(6))
    with pytest.raises(MisuseError, match="2 outputs and 2 inputs"):
        compare(model(), gather([data[0].channel(0, 0)]))
    narrow = FrequencyResponse(OMEGA, data[0].matrices[:, :1], POINTS[0], 1.0, np.full((len(OMEGA), 1, 2), 1e-4))
    with pytest.raises(MisuseError, match="same channels"):
        compare(model(), gather([narrow]))


def test_an_effect_acts_in_its_place_alone() -> None:
    generator = np.random.default_rng(7)
    (batch,) = gather(responses(PLANT, POINTS, NOTHING, generator))
    with_delay = model().plus(placed(Delay(), 0, 2, 0.4, Port(1, None)))
    ratio = with_delay.output(batch) / model().output(batch)
    at_second = batch.ports[:, 0] == 1
    assert np.allclose(ratio[~at_second], 1)
    assert np.allclose(ratio[at_second], np.exp(-0.4j * OMEGA))
