"""What was measured is looked at as Bode, an impedance as Nyquist at equal scales with its verdict."""

import numpy as np

from tests.acceptance.test_measured_response import PLANT, impedance
from tests.support.api import Api
from tests.support.browser import Visit
from tests.support.server import Server

PLOTS = "[...document.querySelectorAll('.js-plotly-plot')]"
PHASE = f"{PLOTS}.find((one) => one.ariaLabel.startsWith('Phase')).data.at(-1).y"
RANGE = f"{PLOTS}.find((one) => one.ariaLabel.startsWith('Gain'))._fullLayout.yaxis.range"
SCALES = """(() => {
  const plots = [...document.querySelectorAll(".js-plotly-plot")];
  const { xaxis, yaxis } = plots.find((one) => one.ariaLabel.startsWith("Nyquist"))._fullLayout;
  const pixels = (axis) => axis._length / Math.abs(axis.range[1] - axis.range[0]);
  return pixels(xaxis) / pixels(yaxis);
})()"""


def test_an_impedance_is_a_curve_at_equal_scales_with_a_verdict(visit: Visit, server: Server) -> None:
    api = Api(server.url)
    plant = api.post("/plants", PLANT)["id"]
    for sign, verdict in ((1.0, "obeys Kramers–Kronig"), (-1.0, "the sign was probably mistaken")):
        made = api.made("/experiments", {**impedance(sign), "plantId": plant})
        page = visit.open(f"/plants/{plant}/experiments/{made['id']}")
        page.get_by_text(verdict).wait_for()
        visit.draw_all()
        assert abs(page.evaluate(SCALES) - 1) < 0.02
        assert visit.violations() == []


def test_a_phase_at_half_a_turn_does_not_jump_and_a_constant_gain_has_room(visit: Visit, server: Server) -> None:
    """Inertia: −180° and noise around it."""
    api, generator = Api(server.url), np.random.default_rng(3)
    named = {**PLANT, "input": {"name": "force", "unit": "N"}, "output": {"name": "way", "unit": "mm"}}
    plant = api.post("/plants", named)["id"]
    omega = np.geomspace(1, 100, 60)
    phase = np.pi + 0.05 * generator.standard_normal(60)
    body = {
        "kind": "frequencyResponse",
        "frequenciesRadPerSecond": omega.tolist(),
        "response": {"re": (2e-6 * np.cos(phase)).tolist(), "im": (2e-6 * np.sin(phase)).tolist()},
        "operatingPoint": [10.0],
    }
    made = api.made("/experiments", {**body, "plantId": plant})
    page = visit.open(f"/plants/{plant}/experiments/{made['id']}")
    visit.draw_all()
    np.testing.assert_allclose(np.array(page.evaluate(PHASE), dtype=float), -180, atol=15)
    low, high = page.evaluate(RANGE)
    assert low < np.log10(2e-6) - 0.2
    assert high > np.log10(2e-6) + 0.2
