"""Impedances of a cell over its charge, without variances: R₀ + R₁ / (1 + jωτ) and what is hidden beside it."""

from collections.abc import Callable

import numpy as np

from benchmarks.campaigns.campaign import Campaign, Truth, campaign
from identification.arrays import ComplexArray, FloatArray

FITTED, HELD_OUT = (10.0, 30.0, 50.0, 70.0, 90.0), (20.0, 60.0)
Hidden = Callable[[FloatArray, float, float, float], ComplexArray]  # by s/j = ω, charge, R₁ and corner


def _cell(case: str, truth: Truth, g: np.random.Generator, hidden: Hidden, exponent: float = 1.0) -> Campaign:
    ohmic, arc, corner = 10 ** g.uniform(-2, -1), 10 ** g.uniform(-1.8, -1), 10 ** g.uniform(1.2, 2.2)
    rise, fall = g.uniform(0.1, 0.5), g.uniform(0.1, 0.5)
    noise = 10 ** g.uniform(-3.3, -2.5)
    omega = np.geomspace(0.01, 100, int(g.integers(35, 60))) * corner
    scale = float(f"{corner:.1g}")

    def resistances(charge: float) -> tuple[float, float]:
        return ohmic * (1 + rise * charge / 100), arc * (1 - fall * charge / 100)

    ends = [resistances(c) for c in (0.0, 100.0)]
    b0 = [ends[0][0], (ends[1][0] - ends[0][0]) / 100]
    b1 = [corner / scale * sum(ends[0]), corner / scale * (sum(ends[1]) - sum(ends[0])) / 100]
    said = {
        "input": {"quantity": "current", "unit": "A"},
        "output": {"quantity": "voltage", "unit": "V"},
        "input_between_samples": None,
        "structure": {"n_a": 1, "n_b": 1, "n_k": 0, "sample_time": None, "frequency_scale": scale},
        "scheduling": {"name": "soc", "unit": "%", "minimum": 0.0, "maximum": 100.0},
        "polynomial_degrees": [0, 1, 1],
        "theta_start": [corner / scale, *b0, *b1],
    }
    made = campaign(case, truth, said)
    for charge in (*FITTED, *HELD_OUT):
        first, second = resistances(charge)
        z = first + second / (1 + (1j * omega / corner) ** exponent) + hidden(omega, charge, arc, corner)
        part = "fitted" if charge in FITTED else "held_out"
        scatter = noise * (g.standard_normal(len(z)) + 1j * g.standard_normal(len(z))) / np.sqrt(2)
        made.response(charge, omega, z * (1 + (part == "fitted") * scatter), part)
    return made


def arc_that_moves(case: str, g: np.random.Generator) -> Campaign:
    """A second arc whose time constant changes over the charge."""
    share, place, change = g.uniform(0.2, 0.6), 10 ** g.uniform(0.8, 1.4) * 1.0, g.uniform(1.5, 3.5)
    place = place if g.random() < 0.5 else 1 / place

    def hidden(omega: FloatArray, charge: float, arc: float, corner: float) -> ComplexArray:
        return np.asarray(share * arc / (1 + 1j * omega / (place * corner) * change ** (charge / 100)))

    return _cell(case, Truth(("rc_arc",)), g, hidden)


def three_in_a_cell(case: str, g: np.random.Generator) -> Campaign:
    """An inductance, a diffusion and a second arc."""
    coil, slow, share = g.uniform(0.05, 0.3), g.uniform(0.2, 0.6), g.uniform(0.2, 0.6)

    def hidden(omega: FloatArray, charge: float, arc: float, corner: float) -> ComplexArray:
        s = 1j * omega / corner
        return np.asarray(arc * (coil * s / 30 + slow * 0.1 / np.sqrt(s) + share / (1 + s / 15)))

    return _cell(case, Truth(("inductance", "warburg", "rc_arc")), g, hidden)


def depressed_arc(case: str, g: np.random.Generator) -> Campaign:
    """The arc has an exponent below one."""
    truth = Truth(("cpe_exponent", "cpe_arc"))
    return _cell(case, truth, g, lambda omega, charge, arc, corner: 0j * omega, g.uniform(0.7, 0.93))
